#include "session/board.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"

namespace thunderhead::session {
namespace {

// The colours of people's marks: the bright ones of Okabe and Ito's palette, in linear sRGB. They
// differ from one another on cloud, sky and ground, also for colour-blind people.
constexpr std::array<glm::vec3, 6> kColors = {{{0.665F, 0.112F, 0.0F},
                                               {0.093F, 0.456F, 0.812F},
                                               {0.871F, 0.775F, 0.054F},
                                               {0.604F, 0.191F, 0.387F},
                                               {0.0F, 0.342F, 0.171F},
                                               {0.791F, 0.347F, 0.0F}}};

}  // namespace

Board::Board(std::vector<Mark> marks) : marks_(std::move(marks)), marks_revision_(1) {
  for (const Mark& mark : marks_) mark_count_ = std::max(mark_count_, mark.id);
}

void Board::ShowDomain(const std::string& domain) {
  if (domain == domain_) return;
  bool changed = false;
  for (Mark& mark : marks_) {
    const bool was_shown = IsShown(mark);
    if (domain_.empty() && mark.domain.empty()) mark.domain = domain;
    const bool is_shown = mark.domain == domain;
    changed = changed || was_shown || is_shown;
    if (was_shown && !is_shown) erased_.push_back(mark.id);
    if (is_shown && !was_shown) {
      std::erase(erased_, mark.id);
      drawn_.insert(mark.id);
    }
  }
  domain_ = domain;
  if (changed) ++marks_revision_;
}

std::vector<Mark> Board::MarksShown() const {
  std::vector<Mark> shown;
  std::ranges::copy_if(marks_, std::back_inserter(shown),
                       [this](const Mark& mark) { return IsShown(mark); });
  return shown;
}

absl::StatusOr<std::uint64_t> Board::Add(std::uint64_t person_id,
                                         std::vector<glm::dvec3> positions_m,
                                         const std::optional<glm::vec3>& color,
                                         const std::string& owner_key) {
  const auto kept = std::ranges::find_if(marks_, [&](const Mark& mark) { return !IsShown(mark); });
  if (marks_.size() >= kMaxMarks && kept != marks_.end()) {
    marks_.erase(kept);
  } else if (marks_.size() >= kMaxMarks) {
    return base::WithDetails(
        absl::FailedPreconditionError(absl::StrCat("the session already has the maximum of ",
                                                   kMaxMarks, " marks; erase some first")),
        {.reason = "TOO_MANY_MARKS",
         .metadata = {{"maximum", absl::StrCat(kMaxMarks)}, {"unit", "marks"}}});
  }
  const glm::vec3 own = kColors[person_id % kColors.size()];
  marks_.push_back(
      {++mark_count_, person_id, std::move(positions_m), color.value_or(own), owner_key, domain_});
  drawn_.insert(mark_count_);
  ++marks_revision_;
  return mark_count_;
}

MarksChange Board::TakeMarksChange() {
  MarksChange change{.erased = std::exchange(erased_, {})};
  for (const Mark& mark : marks_) {
    if (drawn_.contains(mark.id) && IsShown(mark)) change.drawn.push_back(mark);
  }
  drawn_.clear();
  return change;
}

void Board::HandOver(const std::string& owner_key, std::uint64_t person_id) {
  if (owner_key.empty()) return;
  bool changed = false;
  for (Mark& mark : marks_) {
    if (mark.owner_key != owner_key || mark.person_id == person_id) continue;
    mark.person_id = person_id;
    drawn_.insert(mark.id);
    changed = true;
  }
  if (changed) ++marks_revision_;
}

std::uint64_t Board::LastPerson() const {
  std::uint64_t last = 0;
  for (const Mark& mark : marks_) last = std::max(last, mark.person_id);
  return last;
}

bool Board::HasOfOthers(const std::vector<std::uint64_t>& ids, std::uint64_t person_id) const {
  return std::ranges::any_of(marks_, [&](const Mark& mark) {
    return mark.person_id != person_id && std::ranges::find(ids, mark.id) != ids.end();
  });
}

void Board::Erase(const std::vector<std::uint64_t>& ids, std::optional<std::uint64_t> person_id) {
  const auto erased = std::erase_if(marks_, [&](const Mark& mark) {
    const bool erases = IsShown(mark) &&
                        (ids.empty() || std::ranges::find(ids, mark.id) != ids.end()) &&
                        (!person_id.has_value() || mark.person_id == *person_id);
    if (erases) erased_.push_back(mark.id);
    return erases;
  });
  if (erased > 0) ++marks_revision_;
}

void Board::Point(std::uint64_t person_id, const std::optional<glm::dvec3>& position_m) {
  const auto at = std::ranges::find(pointers_, person_id, &Pointer::person_id);
  if (!position_m.has_value()) {
    if (at == pointers_.end()) return;
    pointers_.erase(at);
  } else if (at != pointers_.end()) {
    at->position_m = *position_m;
  } else {
    pointers_.push_back({person_id, *position_m});
  }
  ++pointers_revision_;
}

}  // namespace thunderhead::session
