#include "service/interact/untold_news.h"

#include "rpc_port/wire.h"
#include "service/interact/interact_messages.h"

namespace thunderhead::service {
namespace {

std::optional<grpc::ByteBuffer> News(const session::Told& told, std::uint64_t* count) {
  if (told.count == *count) return std::nullopt;
  *count = told.count;
  return rpc_port::Joined({}, rpc_port::SharedSlice(told.bytes));
}

}  // namespace

std::optional<grpc::ByteBuffer> UntoldNews::Next(session::Session& session,
                                                 const CatalogueFollower& catalogue) {
  session::Audience& audience = session.audience();
  if (const session::Told told = audience.Scene(); told.count != scene_) {
    scene_ = told.count;
    if (const auto newest = session.Newest(); newest.has_value()) return SceneResponse(*newest);
  }
  if (const std::uint64_t changes = catalogue.Changes(); changes != catalogue_) {
    catalogue_ = changes;
    v1::InteractResponse response;
    response.mutable_catalogue_changed()->set_revision(changes);
    return ResponseOf(response);
  }
  if (auto news = News(audience.Presence(person_id_), &presence_); news.has_value()) return news;
  const session::Told marks = audience.Marks(marks_by_changes_ ? marks_ : 0);
  if (auto news = News(marks, &marks_); news.has_value()) return news;
  if (auto news = News(audience.TimesHeld(), &times_); news.has_value()) return news;
  return News(audience.Pointers(), &pointers_);
}

}  // namespace thunderhead::service
