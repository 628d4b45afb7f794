// People show one another on a session's picture: pointers, and marks that they draw. Both are
// places in the world, so they stay where they are when the camera turns. A mark is shown with the
// domain of the storm that it was drawn on, and kept while that of another is. A plain value.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "glm/vec3.hpp"

namespace thunderhead::session {

struct Pointer {
  std::uint64_t person_id = 0;
  glm::dvec3 position_m{0.0};
};

// A line.
struct Mark {
  std::uint64_t id = 0;  // counts a session's marks from 1
  std::uint64_t person_id = 0;
  std::vector<glm::dvec3> positions_m;
  glm::vec3 color{1.0F};  // linear sRGB
  // Secret of who drew it, by which the marks follow the person to a new connection; empty: none.
  std::string owner_key{};
  std::string domain{};  // of the storm that it lies on; empty: not known

  bool operator==(const Mark&) const = default;
};

struct MarksChange {
  std::vector<Mark> drawn;  // or now another person's
  std::vector<std::uint64_t> erased;
};

class Board {
 public:
  static constexpr std::size_t kMaxMarks = 100;

  Board() = default;
  explicit Board(std::vector<Mark> marks);

  // A storm of that domain is shown. Marks of no known domain are of the first.
  void ShowDomain(const std::string& domain);

  // Without a colour, one of the person's own. FAILED_PRECONDITION if too many marks are shown;
  // where others are kept, the oldest of those makes room.
  absl::StatusOr<std::uint64_t> Add(std::uint64_t person_id, std::vector<glm::dvec3> positions_m,
                                    const std::optional<glm::vec3>& color,
                                    const std::string& owner_key = "");
  // The marks with that key are now the person's, who has come back with another id.
  void HandOver(const std::string& owner_key, std::uint64_t person_id);
  // True if one of `ids` is a mark of somebody else.
  bool HasOfOthers(const std::vector<std::uint64_t>& ids, std::uint64_t person_id) const;
  // Erases `ids`, or every mark shown if there are none: of anybody, or only of that person.
  void Erase(const std::vector<std::uint64_t>& ids, std::optional<std::uint64_t> person_id);

  // Moves the person's pointer; without a place it goes.
  void Point(std::uint64_t person_id, const std::optional<glm::dvec3>& position_m);

  // Those of other domains, too.
  const std::vector<Mark>& marks() const { return marks_; }
  std::vector<Mark> MarksShown() const;
  // The marks shown that were drawn or erased since the last call.
  MarksChange TakeMarksChange();
  // The largest id of those who drew them; 0 without marks.
  std::uint64_t LastPerson() const;
  const std::vector<Pointer>& pointers() const { return pointers_; }
  // Count changes.
  std::uint64_t marks_revision() const { return marks_revision_; }
  std::uint64_t pointers_revision() const { return pointers_revision_; }

 private:
  bool IsShown(const Mark& mark) const { return mark.domain == domain_; }

  std::string domain_;  // empty: not known
  std::vector<Mark> marks_;
  std::set<std::uint64_t> drawn_;  // ids for TakeMarksChange
  std::vector<std::uint64_t> erased_;
  std::vector<Pointer> pointers_;
  std::uint64_t mark_count_ = 0;
  std::uint64_t marks_revision_ = 0;
  std::uint64_t pointers_revision_ = 0;
};

}  // namespace thunderhead::session
