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
constexpr size_t kMostKept = size_t{4} << 20U;  // numbers, of all threads together
constexpr size_t kRoomy = 4;                    // what is kept is given to those who need this share of it at least
constexpr size_t kSteps = 8;                    // sizes that are made, from a power of two to the next

struct Piece {
  double* first;
  size_t size;
};

void free(const Piece& piece) {
  operator delete[](piece.first, kCacheLine);
}

class Kept {
 public:
  Kept() = default;
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;
  ~Kept() { std::for_each(piece_.begin(), piece_.end(), free); }

  /// Of the pieces that have room for so many numbers, and not for too many more, the one that was kept last: it is in
  /// the cache still. Nothing where there is none.
  Piece take(size_t count) {
    const std::scoped_lock lock(mutex_);
    const auto has_room = [&](const Piece& p) { return p.size >= count && p.size <= kRoomy * count; };
    const auto found = std::find_if(piece_.rbegin(), piece_.rend(), has_room);
    if (found == piece_.rend()) return {nullptr, 0};
    const Piece result = *found;
    piece_.erase(std::next(found).base());
    sum_ -= result.size;
    return result;
  }

  /// The one that was not asked for longest gives way.
  void keep(const Piece& piece) {
    const std::scoped_lock lock(mutex_);
    piece_.push_back(piece);
    sum_ += piece.size;
    while (sum_ > kMostKept) {
      sum_ -= piece_.front().size;
      free(piece_.front());
      piece_.erase(piece_.begin());
    }
  }

 private:
  std::mutex mutex_;
  std::vector<Piece> piece_;
  size_t sum_ = 0;
};

Kept& kept() {
  static Kept result;
  return result;
}

}  // namespace

NumberStore::NumberStore(size_t count) {
  if (count == 0) return;
  Piece piece = kept().take(count);
  if (piece.first == nullptr) {
    const size_t step = std::max(std::bit_floor(count) / kSteps, size_t{1});
    piece.size = (count + step - 1) / step * step;
    piece.first = static_cast<double*>(operator new[](piece.size * sizeof(double), kCacheLine));
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
