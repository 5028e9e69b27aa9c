// SPDX-License-Identifier: GPL-3.0-or-later
// Files beside a mesh file. Only regular files are opened, so that no pipe or device can hold the importer.
#include "import/import_files.h"

#include <algorithm>
#include <cstring>

#include "geocloth/asset/output_file.h"
#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string decode_percent(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int high = i + 2 < text.size() && text[i] == '%' ? hex_digit(text[i + 1]) : -1;
    const int low = high >= 0 ? hex_digit(text[i + 2]) : -1;
    if (low >= 0) {
      out.push_back(static_cast<char>(high * 16 + low));
      i += 2;
    } else {
      out.push_back(text[i]);
    }
  }
  return out;
}

bool is_file(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

/// A reference as a path with slashes.
std::string slashed(std::string_view reference) {
  std::string text(reference.substr(0, reference.find('\0')));
  std::replace(text.begin(), text.end(), '\\', '/');
  if (text.starts_with("file://")) text.erase(0, 7);
  return text;
}

/// How far references may lead.
enum class Reach : uint8_t { folder, anywhere };

bool leaves_folder(const std::filesystem::path& reference) {
  const std::filesystem::path normal = reference.lexically_normal();
  return normal.is_absolute() || (!normal.empty() && *normal.begin() == "..");
}

/// The file that a reference points to, or else the one of that name beside the mesh.
std::optional<std::filesystem::path> find_file(const std::filesystem::path& mesh_file, const std::string& text,
                                               Reach reach) {
  const std::filesystem::path folder = mesh_file.parent_path();
  for (const std::string& form : {text, decode_percent(text)}) {
    const bool is_near = reach == Reach::anywhere || !leaves_folder(form);
    if (is_near && is_file(folder / form)) return folder / form;
    std::filesystem::path beside = folder / std::filesystem::path(form).filename();
    if (is_file(beside)) return beside;
  }
  return std::nullopt;
}

/// @returns false when the text is no base64
bool decode_base64(std::string_view text, std::vector<std::byte>& out) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (text.ends_with('=')) text.remove_suffix(1);
  out.reserve(text.size() / 4 * 3 + 2);
  uint32_t bits = 0, count = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) return false;
    bits = (bits << 6U | static_cast<uint32_t>(digit)) & 0xFFFFFFU;
    count += 6;
    if (count < 8) continue;
    count -= 8;
    out.push_back(static_cast<std::byte>(bits >> count & 0xFFU));
  }
  return true;
}

}  // namespace

std::filesystem::path resolve(const std::filesystem::path& mesh_file, std::string_view reference) {
  const std::string text = slashed(reference);
  return find_file(mesh_file, text, Reach::anywhere).value_or(mesh_file.parent_path() / text);
}

std::vector<std::byte> read_uri(const std::filesystem::path& mesh_file, const std::string& uri,
                                const std::string& where) {
  if (!uri.starts_with("data:")) {
    const std::string text = slashed(uri);
    if (const auto file = find_file(mesh_file, text, Reach::folder)) return read_file(*file, kMaxFileBytes);
    if (find_file(mesh_file, text, Reach::anywhere)) {
      fail(mesh_file, ErrorCode::unsupported,
           where + " is in the file '" + text.substr(0, 200) +
               "', outside of the mesh file's folder, where nothing is opened; put it beside the mesh file, or export "
               "as .glb");
    }
    fail(mesh_file, ErrorCode::io,
         where + " is in the file '" + std::filesystem::path(text).filename().string().substr(0, 200) +
             "', which is not beside the mesh file");
  }
  const std::size_t comma = uri.find(',');
  std::vector<std::byte> bytes;
  const bool encoded = comma != std::string::npos && uri.substr(0, comma).ends_with(";base64");
  if (!encoded || !decode_base64(std::string_view(uri).substr(comma + 1), bytes)) {
    fail(mesh_file, ErrorCode::invalid_data, where + " holds a data URI that is not base64; is the file cut off?");
  }
  return bytes;
}

std::optional<std::string> picture_type(const std::vector<uint8_t>& bytes) {
  const auto starts = [&](std::string_view magic) {
    return bytes.size() > magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
  };
  if (starts("\x89PNG\r\n\x1a\n")) return "image/png";
  if (starts("\xFF\xD8\xFF")) return "image/jpeg";
  return std::nullopt;
}

std::optional<std::vector<uint8_t>> read_picture(const std::filesystem::path& mesh_file, std::string_view reference) {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t{256} << 20U;
  const std::filesystem::path file = resolve(mesh_file, reference);
  std::error_code error;
  if (!is_file(file) || std::filesystem::file_size(file, error) > kMaxBytes || error) return std::nullopt;
  try {
    const std::vector<std::byte> raw = read_file(file, kMaxBytes);
    std::vector<uint8_t> bytes(raw.size());
    std::transform(raw.begin(), raw.end(), bytes.begin(), [](std::byte b) { return static_cast<uint8_t>(b); });
    if (!picture_type(bytes)) return std::nullopt;
    return bytes;
  } catch (const Error&) {
    return std::nullopt;  // a picture that cannot be read leaves the mesh as it is
  }
}

}  // namespace geocloth::import_detail
