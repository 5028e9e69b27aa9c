// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "geocloth/asset/error.h"

namespace geocloth {

inline constexpr const char* kSavedState = "saved state: ";  ///< begins what is said of one that is refused

[[noreturn]] inline void refuse_state(const std::string& problem) {
  throw Error(ErrorCode::invalid_data, kSavedState + problem);
}

// StateWriter and StateReader have the same functions, so that one text says what is written and what is read.

/// Appends values to bytes as they lie in memory.
class StateWriter {
 public:
  explicit StateWriter(std::vector<std::byte>& bytes) : bytes_(bytes) { bytes_.clear(); }

  template <class T>
  void value(T& v) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>);
    add(&v, sizeof(T));
  }
  void flag(bool& v) {
    uint8_t byte = v ? 1 : 0;
    value(byte);
  }
  /// @param least  bytes that each entry takes
  template <class T, class Entry>
  void entries(std::vector<T>& list, size_t, const Entry& entry) {
    uint64_t count = list.size();
    value(count);
    for (T& v : list) entry(v);
  }
  template <class T>
  void values(std::vector<T>& list) {
    static_assert(std::is_trivially_copyable_v<T>);
    uint64_t count = list.size();
    value(count);
    if (count > 0) add(list.data(), count * sizeof(T));
  }
  void text(std::string& v) {
    uint64_t count = v.size();
    value(count);
    add(v.data(), count);
  }
  template <class T, class Held>
  void optional(std::optional<T>& v, const Held& held) {
    bool has = v.has_value();
    flag(has);
    if (has) held(*v);
  }

 private:
  void add(const void* from, size_t count) {
    const auto* const first = static_cast<const std::byte*>(from);
    bytes_.insert(bytes_.end(), first, first + count);
  }

  std::vector<std::byte>& bytes_;
};

/// Reads them again. Nothing is taken for granted: not that there are as many, nor how many a list says it has.
class StateReader {
 public:
  explicit StateReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  void value(T& v) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>);
    take(&v, sizeof(T));
  }
  void flag(bool& v) {
    uint8_t byte = 0;
    value(byte);
    if (byte > 1)
      refuse_state("byte " + std::to_string(at_ - 1) + " is " + std::to_string(byte) + " instead of 0 or 1");
    v = byte == 1;
  }
  template <class T, class Entry>
  void entries(std::vector<T>& list, size_t least, const Entry& entry) {
    list.clear();
    for (uint64_t left = count_of(least); left > 0; --left) entry(list.emplace_back());
  }
  template <class T>
  void values(std::vector<T>& list) {
    static_assert(std::is_trivially_copyable_v<T>);
    list.resize(count_of(sizeof(T)));
    if (!list.empty()) take(list.data(), list.size() * sizeof(T));
  }
  void text(std::string& v) {
    v.resize(count_of(1));
    take(v.data(), v.size());
  }
  template <class T, class Held>
  void optional(std::optional<T>& v, const Held& held) {
    bool has = false;
    flag(has);
    v.reset();
    if (!has) return;
    v = T{};
    held(*v);
  }
  void end() const {
    if (at_ < bytes_.size()) refuse_state("it has " + std::to_string(bytes_.size() - at_) + " bytes too many");
  }

 private:
  [[nodiscard]] size_t left() const { return bytes_.size() - at_; }
  size_t count_of(size_t least) {
    uint64_t count = 0;
    value(count);
    if (count > left() / least) {
      refuse_state("it ends after " + std::to_string(bytes_.size()) + " bytes, before a list of " +
                   std::to_string(count) + " entries does");
    }
    return static_cast<size_t>(count);
  }
  void take(void* to, size_t count) {
    if (count > left()) refuse_state("it ends after " + std::to_string(bytes_.size()) + " bytes; some are missing");
    if (count > 0) std::memcpy(to, bytes_.data() + at_, count);
    at_ += count;
  }

  std::span<const std::byte> bytes_;
  size_t at_ = 0;
};

/// Tells sequences of values apart; 64-bit FNV-1a over words.
class StateMark {
 public:
  template <class T>
  void add(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_bytes(&v, sizeof(T));
  }
  template <class T>
  void add(const std::vector<T>& list) {
    add(uint64_t{list.size()});
    if (!list.empty()) add_bytes(list.data(), list.size() * sizeof(T));
  }
  [[nodiscard]] uint64_t get() const { return mark_; }

 private:
  void add_bytes(const void* from, size_t count) {
    const auto* byte = static_cast<const unsigned char*>(from);
    for (; count >= sizeof(uint64_t); count -= sizeof(uint64_t), byte += sizeof(uint64_t)) {
      uint64_t word = 0;
      std::memcpy(&word, byte, sizeof(word));
      mix(word);
    }
    for (; count > 0; --count) mix(*byte++);
  }
  void mix(uint64_t word) {
    mark_ = (mark_ ^ word) * 0x100000001B3U;
    mark_ ^= mark_ >> 29U;  // else a word's upper bits never reach the lower ones
  }

  uint64_t mark_ = 0xCBF29CE484222325U;
};

}  // namespace geocloth
