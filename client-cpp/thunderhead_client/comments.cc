// The comments of scene.proto. The build embeds scene.proto with its source information
// (cmake/embed_bytes.cmake).
#include <map>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "google/protobuf/descriptor.pb.h"
#include "thunderhead_client/parameters.h"
#include "thunderhead_client/scene_descriptors.h"

namespace thunderhead::client {
namespace {

using google::protobuf::DescriptorProto;
using google::protobuf::FileDescriptorProto;
using google::protobuf::FileDescriptorSet;
using Comments = std::map<std::string, std::string, std::less<>>;
using Place = std::vector<int>;

std::string FirstSentence(const std::string& comment) {
  std::string text;
  for (const char letter : comment) text += letter == '\n' ? ' ' : letter;
  absl::RemoveExtraAsciiWhitespace(&text);
  for (std::size_t at = text.find(". "); at != std::string::npos; at = text.find(". ", at + 1)) {
    // An abbreviation such as "et al. 2003" does not end a sentence.
    if (absl::ascii_isupper(static_cast<unsigned char>(text[at + 2])))
      return text.substr(0, at + 1);
  }
  return text;
}

std::map<Place, std::string> SentencesOf(const FileDescriptorProto& file) {
  std::map<Place, std::string> sentences;
  for (const auto& location : file.source_code_info().location()) {
    if (!location.has_leading_comments()) continue;
    sentences[Place(location.path().begin(), location.path().end())] =
        FirstSentence(location.leading_comments());
  }
  return sentences;
}

void AddMessage(const DescriptorProto& message, const std::string& name, const Place& place,
                const std::map<Place, std::string>& sentences, Comments& comments) {
  for (int i = 0; i < message.field_size(); ++i) {
    Place at = place;
    at.insert(at.end(), {DescriptorProto::kFieldFieldNumber, i});
    const auto found = sentences.find(at);
    if (found != sentences.end()) {
      comments[absl::StrCat(name, ".", message.field(i).name())] = found->second;
    }
  }
  for (int i = 0; i < message.nested_type_size(); ++i) {
    Place at = place;
    at.insert(at.end(), {DescriptorProto::kNestedTypeFieldNumber, i});
    const DescriptorProto& nested = message.nested_type(i);
    AddMessage(nested, absl::StrCat(name, ".", nested.name()), at, sentences, comments);
  }
}

Comments ReadComments() {
  Comments comments;
  FileDescriptorSet files;
  const std::string_view bytes = SceneDescriptors();
  if (!files.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return comments;
  for (const FileDescriptorProto& file : files.file()) {
    const auto sentences = SentencesOf(file);
    for (int i = 0; i < file.message_type_size(); ++i) {
      const DescriptorProto& message = file.message_type(i);
      AddMessage(message, absl::StrCat(file.package(), ".", message.name()),
                 {FileDescriptorProto::kMessageTypeFieldNumber, i}, sentences, comments);
    }
  }
  return comments;
}

}  // namespace

std::string_view CommentOf(std::string_view full_name) {
  static const Comments comments = ReadComments();
  const auto found = comments.find(full_name);
  return found == comments.end() ? std::string_view() : found->second;
}

}  // namespace thunderhead::client
