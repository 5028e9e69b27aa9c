// SPDX-License-Identifier: Apache-2.0
// Atomic files the POSIX way: write beside the target, then rename(2), which replaces in one step. What a signal
// handler has to remove stands in a list of slots that only ever grows: the handler takes the name out of a slot with
// one atomic exchange and unlinks it, and whoever took the name owns it, so handler and destructor never meet.
#include "geocloth/asset/output_file.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "geocloth/asset/error.h"

namespace geocloth {
namespace {

namespace fs = std::filesystem;

struct Slot {
  std::atomic<char*> name{nullptr};
  std::atomic<char*> removed{nullptr};  ///< the name, once the handler has unlinked it: it may not free memory
  Slot* next = nullptr;
};
static_assert(std::atomic<char*>::is_always_lock_free, "a signal handler may only use lock-free atomics");

std::atomic<Slot*> first_slot{nullptr};

struct FreeSlots {
  std::mutex mutex;
  std::vector<Slot*> slots;
};
FreeSlots& free_slots() {
  static auto* instance = new FreeSlots;  // outlives every static OutputFile
  return *instance;
}

/// Adds a file to the list; the name may not change until unregister_file().
Slot* register_file(const fs::path& path) {
  const std::string& text = path.native();
  char* name = new char[text.size() + 1];
  std::memcpy(name, text.c_str(), text.size() + 1);
  FreeSlots& free = free_slots();
  const std::scoped_lock lock(free.mutex);
  Slot* slot = nullptr;
  if (free.slots.empty()) {
    slot = new Slot;
    slot->next = first_slot.load();
    slot->name = name;
    first_slot = slot;
  } else {
    slot = free.slots.back();
    free.slots.pop_back();
    slot->name = name;
  }
  return slot;
}

void unregister_file(Slot* slot) {
  delete[] slot->name.exchange(nullptr);
  delete[] slot->removed.exchange(nullptr);
  FreeSlots& free = free_slots();
  const std::scoped_lock lock(free.mutex);
  free.slots.push_back(slot);
}

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ErrorCode::io, path.string() + ": " + what);
}
[[noreturn]] void fail_errno(const fs::path& path, const std::string& what, int error) {
  fail(path, what + ": " + std::generic_category().message(error));
}

/// The file that a path means: through symbolic links, so that a link stays a link.
fs::path resolve_target(fs::path path) {
  if (path.empty()) throw Error(ErrorCode::io, "the output file has an empty name; give a file name");
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) fail(path, "is a directory; give a file name");
  if (fs::exists(status) && !fs::is_regular_file(status)) fail(path, "is not a regular file; give a file name");
  if (!path.has_filename()) fail(path, "ends in a slash; give a file name");
  if (fs::is_symlink(fs::symlink_status(path, error))) {
    const fs::path target = fs::weakly_canonical(path, error);
    if (!error) path = target;
  }
  return path;
}

std::atomic<uint32_t> next_temporary{0};

/// A short name, so that a final name as long as the file system allows still works.
fs::path temporary_name(const fs::path& path) {
  const std::string ending = path.extension().string();
  return path.parent_path() / (".geocloth-" + std::to_string(getpid()) + "-" + std::to_string(next_temporary++) +
                               (ending.size() <= 16 ? ending : std::string{}));
}

}  // namespace

std::vector<std::byte> read_file(const fs::path& path, std::uintmax_t max_bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    fail(path, status.type() == fs::file_type::not_found ? "no such file; check the name"
                                                         : "cannot be read: " + error.message());
  }
  if (fs::is_directory(status)) fail(path, "is a directory; give a file");
  if (!fs::is_regular_file(status)) fail(path, "is not a regular file; give a file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) fail(path, "cannot be read: " + error.message());
  if (size > max_bytes || size > std::numeric_limits<std::size_t>::max()) {
    fail(path, "has " + std::to_string(size) + " bytes; at most " + std::to_string(max_bytes) + " are read");
  }
  std::FILE* file = std::fopen(path.c_str(), "rbe");
  if (file == nullptr) fail_errno(path, "cannot be read", errno);
  std::vector<std::byte> bytes;
  try {
    bytes.resize(static_cast<std::size_t>(size));
  } catch (const std::bad_alloc&) {
    std::fclose(file);
    throw Error(ErrorCode::limit, path.string() + ": has " + std::to_string(size) + " bytes, more than memory holds");
  }
  const std::size_t got = std::fread(bytes.data(), 1, bytes.size(), file);
  const int read_error = std::ferror(file) != 0 ? errno : 0;
  std::fclose(file);
  if (read_error != 0) fail_errno(path, "cannot be read", read_error);
  bytes.resize(got);
  return bytes;
}

OutputFile::OutputFile(fs::path path) : path_(resolve_target(std::move(path))) {
  int handle = -1;
  int error = 0;
  Slot* slot = nullptr;
  do {  // a name may be taken by a process that died and whose number we have
    if (slot != nullptr) unregister_file(slot);
    temporary_ = temporary_name(path_);
    // Before it exists: an interrupt may come at once.
    slot = register_file(temporary_);
    handle = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    error = errno;
  } while (handle < 0 && error == EEXIST);
  if (handle < 0) {
    unregister_file(slot);
    std::error_code ignored;
    const fs::path folder = path_.has_parent_path() ? path_.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, ignored)) fail(path_, "the folder " + folder.string() + " does not exist; make it");
    fail_errno(path_, "cannot be written", error);
  }
  registration_ = slot;
  file_ = ::fdopen(handle, "wb");
  if (file_ == nullptr) {
    error = errno;
    ::close(handle);
    ::unlink(temporary_.c_str());
    unregister_file(slot);
    fail_errno(path_, "cannot be written", error);
  }
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) std::fclose(file_);
  if (registration_ == nullptr) return;
  ::unlink(temporary_.c_str());
  unregister_file(static_cast<Slot*>(registration_));
}

void OutputFile::write(std::span<const std::byte> bytes) {
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) {
    fail_errno(path_, "cannot be written", errno);
  }
}

void OutputFile::write(std::string_view text) {
  write(std::as_bytes(std::span(text.data(), text.size())));
}

void OutputFile::append_file(const fs::path& path) {
  std::FILE* source = std::fopen(path.c_str(), "rbe");
  if (source == nullptr) fail_errno(path, "cannot be read", errno);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> owner(source, std::fclose);
  std::vector<std::byte> block(std::size_t{1} << 20U);
  while (const std::size_t got = std::fread(block.data(), 1, block.size(), source)) {
    write(std::span(block).first(got));
  }
  if (std::ferror(source) != 0) fail_errno(path, "cannot be read", errno);
}

void OutputFile::seek(std::uint64_t offset) {
  if (::fseeko(file_, static_cast<off_t>(offset), SEEK_SET) != 0) fail_errno(path_, "cannot be written", errno);
}

void OutputFile::close() {
  if (file_ == nullptr) return;
  const int result = std::fclose(std::exchange(file_, nullptr));
  if (result != 0) fail_errno(path_, "cannot be written", errno);
}

void OutputFile::commit() {
  close();
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail_errno(path_, "cannot be written", errno);
  unregister_file(static_cast<Slot*>(std::exchange(registration_, nullptr)));
}

OutputFile& OutputSeries::add(fs::path path) {
  return files_.emplace_back(std::move(path));
}

OutputFile& OutputSeries::open(fs::path path) {
  if (!files_.empty()) files_.back().close();
  return add(std::move(path));
}

void OutputSeries::close() {
  for (OutputFile& file : files_) file.close();
}

void OutputSeries::commit() {
  std::vector<Slot*> renamed;
  renamed.reserve(files_.size());
  try {
    for (OutputFile& file : files_) {
      file.commit();
      renamed.push_back(register_file(file.path()));
    }
  } catch (...) {
    for (std::size_t i = 0; i < renamed.size(); ++i) {
      ::unlink(files_[i].path().c_str());
      unregister_file(renamed[i]);
    }
    throw;
  }
  for (Slot* slot : renamed) unregister_file(slot);
  files_.clear();
}

fs::path numbered_path(const fs::path& path, uint32_t number) {
  std::string digits = std::to_string(number);
  if (digits.size() < 4) digits.insert(0, 4 - digits.size(), '0');
  return path.parent_path() / (path.stem().string() + "_" + digits + path.extension().string());
}

void write_file(const fs::path& path, std::span<const std::byte> bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

void write_file(const fs::path& path, std::string_view text) {
  write_file(path, std::as_bytes(std::span(text.data(), text.size())));
}

void remove_unfinished_files() noexcept {
  for (Slot* slot = first_slot.load(); slot != nullptr; slot = slot->next) {
    if (char* name = slot->name.exchange(nullptr); name != nullptr) {
      ::unlink(name);
      slot->removed = name;
    }
  }
}

}  // namespace geocloth
