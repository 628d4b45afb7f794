#include "interchange/vdb_sizes.h"

#include <openvdb/Metadata.h>

#include <cstdint>
#include <stdexcept>
#include <string>

#include "absl/strings/str_cat.h"

namespace thunderhead::interchange {
namespace {

// A walk through a part of a stream. Return() moves the stream back to where the walk began. After
// an exception the place is irrelevant, because the file is refused.
class Walk {
 public:
  explicit Walk(std::istream& in) : in_(in), begin_(in.tellg()) {
    in_.seekg(0, std::ios::end);
    end_ = in_.tellg();
    in_.seekg(begin_);
  }
  void Return() { in_.seekg(begin_); }

  std::uint32_t Number() {
    std::uint32_t number = 0;
    in_.read(reinterpret_cast<char*>(&number), sizeof(number));
    return number;
  }

  // Reads the size of what is called `what` in errors, and returns it if so many bytes follow.
  std::uint32_t Size(const char* what) {
    const auto place = static_cast<std::int64_t>(in_.tellg());
    const std::uint32_t size = Number();
    const std::int64_t rest = static_cast<std::int64_t>(end_ - in_.tellg());
    if (size <= rest) return size;
    throw std::runtime_error(absl::StrCat(what, " at byte ", place, " is said to have ", size,
                                          " bytes, but ", rest, " follow"));
  }

  void Skip(std::uint32_t bytes) { in_.seekg(bytes, std::ios::cur); }
  void SkipText(const char* what) { Skip(Size(what)); }

  std::string Text(const char* what) {
    std::string text(Size(what), '\0');
    in_.read(text.data(), static_cast<std::streamsize>(text.size()));
    return text;
  }

  void Metadata() {
    const std::uint32_t count = Number();
    for (std::uint32_t i = 0; i < count; ++i) {
      SkipText("the name of metadata");
      const std::string type = Text("the type of metadata");
      const std::uint32_t bytes = Size("the value of metadata");
      CheckValue(type, bytes);
      Skip(bytes);
    }
  }

 private:
  // OpenVDB ignores the stated size of a value whose type has a fixed size. It would then read the
  // next size at another place than this walk.
  static void CheckValue(const std::string& type, std::uint32_t bytes) {
    if (type == openvdb::StringMetadata::staticTypeName()) return;
    if (!openvdb::Metadata::isRegisteredType(type)) return;
    const std::uint32_t fixed = openvdb::Metadata::createMetadata(type)->size();
    if (bytes == fixed) return;
    throw std::runtime_error(absl::StrCat("a value of the type ", type, " is said to have ", bytes,
                                          " bytes, but has ", fixed));
  }

  std::istream& in_;
  const std::istream::pos_type begin_;
  std::istream::pos_type end_;
};

}  // namespace

void CheckStatedMetadata(std::istream& in) {
  Walk walk(in);
  walk.Metadata();
  walk.Return();
}

void CheckStatedEntry(std::istream& in) {
  Walk walk(in);
  walk.SkipText("the name of a grid");
  walk.SkipText("the type of a grid");
  walk.SkipText("the name of a grid's parent");
  walk.Return();
}

void CheckStatedGrid(std::istream& in) {
  Walk walk(in);
  walk.Number();  // the compression
  walk.Metadata();
  walk.SkipText("the type of a transform");
  walk.Return();
}

}  // namespace thunderhead::interchange
