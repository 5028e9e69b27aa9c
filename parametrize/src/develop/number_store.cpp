// SPDX-License-Identifier: GPL-3.0-or-later
#include "develop/number_store.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace geocloth {
namespace {

constexpr std::align_val_t kCacheLine{64};
constexpr size_t kMuchKept = size_t{4} << 20U;  // numbers, of all threads together; more where more were in use at once
constexpr size_t kMostRoom = 4;                 // what is kept is given to those who need this share of it at least
constexpr size_t kSizesPerDoubling = 8;         // sizes that are made, from a power of two to the next

struct KeptNumbers {
  double* first;
  size_t size;
};

void give_back(const KeptNumbers& piece) {
  operator delete[](piece.first, kCacheLine);
}

class Kept {
 public:
  Kept() = default;
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;
  ~Kept() { std::for_each(numbers_.begin(), numbers_.end(), give_back); }

  /// Of the pieces that have room for so many numbers, and not for too many more, the one that was kept last: it is in
  /// the cache still. Nothing where there is none.
  KeptNumbers take(size_t count) {
    const std::scoped_lock lock(mutex_);
    const auto has_room = [&](const KeptNumbers& p) { return p.size >= count && p.size <= kMostRoom * count; };
    const auto found = std::find_if(numbers_.rbegin(), numbers_.rend(), has_room);
    if (found == numbers_.rend()) return {nullptr, 0};
    const KeptNumbers result = *found;
    numbers_.erase(std::next(found).base());
    sum_ -= result.size;
    hand_out(result.size);
    return result;
  }

  void made_new(size_t size) {
    const std::scoped_lock lock(mutex_);
    hand_out(size);
  }

  /// Those that were kept first give way.
  void keep(const KeptNumbers& piece) {
    const std::scoped_lock lock(mutex_);
    numbers_.push_back(piece);
    sum_ += piece.size;
    in_use_ -= piece.size;
    while (sum_ > std::max(kMuchKept, most_in_use_)) {
      sum_ -= numbers_.front().size;
      give_back(numbers_.front());
      numbers_.erase(numbers_.begin());
    }
  }

 private:
  void hand_out(size_t size) {
    in_use_ += size;
    most_in_use_ = std::max(most_in_use_, in_use_);
  }

  std::mutex mutex_;
  std::vector<KeptNumbers> numbers_;
  size_t sum_ = 0;  // of what is kept
  size_t in_use_ = 0, most_in_use_ = 0;
};

Kept& kept() {
  static Kept result;
  return result;
}

}  // namespace

NumberStore::NumberStore(size_t count) {
  if (count == 0) return;
  KeptNumbers piece = kept().take(count);
  if (piece.first == nullptr) {
    const size_t step = std::max(std::bit_floor(count) / kSizesPerDoubling, size_t{1});
    piece.size = (count + step - 1) / step * step;
    piece.first = static_cast<double*>(operator new[](piece.size * sizeof(double), kCacheLine));
    kept().made_new(piece.size);
  }
  first_ = piece.first;
  size_ = piece.size;
}

NumberStore::NumberStore(NumberStore&& other) noexcept
    : first_(std::exchange(other.first_, nullptr)), size_(std::exchange(other.size_, 0)) {}

NumberStore& NumberStore::operator=(NumberStore&& other) noexcept {
  std::swap(first_, other.first_);
  std::swap(size_, other.size_);
  return *this;
}

NumberStore::~NumberStore() {
  if (first_ != nullptr) kept().keep({first_, size_});
}

}  // namespace geocloth
