// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/assimp_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <span>
#include <utility>

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/config.h>

#include "geocloth/asset/output_file.h"
#include "import/import_files.h"

#if defined(__SANITIZE_ADDRESS__)
// assimp 5.2.5 leaves tokens of a broken FBX file behind, and that is not to be laid at our door.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libassimp";
}
#endif

namespace geocloth::import_detail {
namespace {

class MemoryStream final : public Assimp::IOStream {
 public:
  explicit MemoryStream(std::string bytes) : bytes_(std::move(bytes)) {}
  std::size_t Read(void* buffer, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    const std::size_t whole = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(buffer, bytes_.data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
    if (offset > bytes_.size() - base) return aiReturn_FAILURE;
    at_ = base + offset;
    return aiReturn_SUCCESS;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

/// Serves files from memory, and others from beside the mesh. Nothing can be written.
class MeshFiles final : public Assimp::IOSystem {
 public:
  MeshFiles(std::filesystem::path mesh, std::vector<MemoryFile> files)
      : mesh_(std::move(mesh)), files_(std::move(files)) {}

  bool Exists(const char* file) const override {
    std::error_code error;
    return in_memory(file) != nullptr || std::filesystem::is_regular_file(resolve(mesh_, file), error);
  }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    if (std::strchr(mode, 'w') != nullptr) return nullptr;
    if (const MemoryFile* known = in_memory(file)) return new MemoryStream(known->bytes);
    if (!Exists(file)) return nullptr;
    try {
      const std::vector<std::byte> bytes = read_file(resolve(mesh_, file), kMaxFileBytes);
      std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      const bool obj = std::string_view(files_[0].name).ends_with(".obj");
      return new MemoryStream(obj ? clean_mtl(text) : std::move(text));
    } catch (const Error&) {
      return nullptr;
    }
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  const MemoryFile* in_memory(std::string_view name) const {
    if (name.starts_with("./")) name.remove_prefix(2);
    const auto it = std::find_if(files_.begin(), files_.end(), [&](const MemoryFile& f) { return f.name == name; });
    return it != files_.end() ? &*it : nullptr;
  }

  std::filesystem::path mesh_;
  std::vector<MemoryFile> files_;
};

/// Some editors open every UTF-8 text with it.
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// By its byte order mark, or by the zero beside its first letter.
bool looks_like_utf16(std::string_view text) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) return true;
  if (text.size() < 4) return false;
  const auto is_ascii = [](char c) { return c > 0 && c < 127; };
  return (is_ascii(text[0]) && text[1] == 0 && is_ascii(text[2]) && text[3] == 0) ||
         (text[0] == 0 && is_ascii(text[1]) && text[2] == 0 && is_ascii(text[3]));
}

void refuse_utf16(const std::filesystem::path& file, std::string_view text) {
  if (!looks_like_utf16(text)) return;
  fail(file, ErrorCode::unsupported, "its text is UTF-16, as some editors and shells write it; save it as UTF-8");
}

std::string_view without_mark(std::span<const std::byte> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

std::vector<std::byte> read_not_empty(const std::filesystem::path& file) {
  std::vector<std::byte> bytes = read_file(file, kMaxFileBytes);
  if (bytes.empty()) fail(file, ErrorCode::invalid_data, "the file is empty");
  return bytes;
}

/// Whether a glTF file is GLB, which shows in its first byte, whatever the ending says.
bool is_container(Format format, std::string_view text) {
  return format == Format::glb ? !text.starts_with('{') : text.starts_with("glTF");
}

/// What assimp gets to see of a file: the file first, then what goes with it. The name's ending decides the reader.
/// @param out  gets what else there is to know of the file
std::vector<MemoryFile> prepare(const std::filesystem::path& file, std::span<const std::byte> bytes, AssimpFile& out,
                                bool animated) {
  std::string text(without_mark(bytes));
  if (out.format != Format::stl) refuse_utf16(file, text);  // a binary STL opens with whatever its program likes
  switch (out.format) {
    case Format::gltf:
    case Format::glb:
      return read_gltf(file, bytes, is_container(out.format, text), out.left_out);
    case Format::off:
      text = off_as_obj(file, text);
      out.format = Format::obj;
      [[fallthrough]];
    case Format::obj:
      out.obj = read_obj(file, text);
      return {{"mesh.obj", std::move(out.obj.coded)}};
    case Format::ply:
      return {{"mesh.ply", checked_ply(file, std::move(text))}};
    case Format::stl:
      return {{"mesh.stl", checked_stl(file, std::move(text))}};
    case Format::fbx:
      return {{"mesh.fbx", checked_fbx(file, std::move(text), animated, out.points)}};
    case Format::dae: {
      DaeText dae = read_dae(file, text, animated);
      out.applied_unit = dae.metres_per_unit;
      out.points = std::move(dae.points);
      return {{"mesh.dae", std::move(dae.text)}};
    }
  }
  return {};
}

}  // namespace

Format format_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const std::map<std::string, Format> known{{".obj", Format::obj}, {".gltf", Format::gltf}, {".glb", Format::glb},
                                            {".ply", Format::ply}, {".stl", Format::stl},   {".fbx", Format::fbx},
                                            {".dae", Format::dae}, {".vrm", Format::glb},   {".off", Format::off}};
  const auto it = known.find(ending);
  if (it != known.end()) return it->second;
  fail(file, ErrorCode::unsupported,
       "unknown ending '" + ending +
           "'; geocloth reads .obj, .gltf, .glb, .vrm, .ply, .stl, .off, .fbx and .dae: export the mesh as one of "
           "these");
}

bool is_gltf(const std::filesystem::path& file) {
  const Format format = format_of(file);
  return format == Format::gltf || format == Format::glb;
}

GltfBytes read_gltf_bytes(const std::filesystem::path& file) {
  GltfBytes out{read_not_empty(file)};
  const std::string_view text = without_mark(out.bytes);
  refuse_utf16(file, text);
  out.binary = is_container(format_of(file), text);
  return out;
}

AssimpFile::AssimpFile(const std::filesystem::path& file, bool animated) : format(format_of(file)) {
  const std::vector<std::byte> bytes = read_not_empty(file);
  std::vector<MemoryFile> files = prepare(file, bytes, *this, animated);
  const std::string name = files[0].name;
  importer.SetIOHandler(new MeshFiles(file, std::move(files)));
  // FBX: a node for each model, unless it is to move by each of its parts.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, animated);
  // Of a skeleton without a mesh, assimp makes a mesh of its own.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  scene = importer.ReadFile(name, 0);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    fail(file, ErrorCode::invalid_data,
         "cannot be read as a mesh (" + std::string(importer.GetErrorString()) + "); is the file cut off or damaged?");
  }
}

double metres_per_unit(const AssimpFile& file) {
  const aiMetadata* data = file.scene->mMetaData;
  if (file.format != Format::fbx || data == nullptr) return 1;
  double centimetres = 0;
  float single = 0;
  if (!data->Get("UnitScaleFactor", centimetres)) {
    if (!data->Get("UnitScaleFactor", single)) return 1;
    centimetres = double{single};
  }
  return std::isfinite(centimetres) && centimetres > 0 ? centimetres * 0.01 : 1;
}

}  // namespace geocloth::import_detail
