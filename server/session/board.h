// The pointers and marks with which people point at things in a session's picture. Both are
// positions in the world, so they stay in place when the camera turns. A mark belongs to the domain
// (region) of the storm that it was drawn on, and is hidden while a storm of another domain is
// shown. A plain value.
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

// A line that a person has drawn.
struct Mark {
  std::uint64_t id = 0;  // number of the mark in its session, from 1
  std::uint64_t person_id = 0;
  std::vector<glm::dvec3> positions_m;
  glm::vec3 color{1.0F};  // linear sRGB
  // Secret key of the person who drew it; empty if unknown. The key gives the marks to the person's
  // new connection after a lost one.
  std::string owner_key{};
  // Domain (storm_store::DomainOf) of the storm that it was drawn on; empty if not known.
  std::string domain{};

  bool operator==(const Mark&) const = default;
};

struct MarksChange {
  std::vector<Mark> drawn;  // new marks, marks that are shown again, and
                            // marks that now belong to another person
  std::vector<std::uint64_t> erased;
};

class Board {
 public:
  static constexpr std::size_t kMaxMarks = 100;

  Board() = default;
  explicit Board(std::vector<Mark> marks);

  // Records that a storm of that domain is shown. Marks whose domain is not known get the first
  // domain that is shown.
  void ShowDomain(const std::string& domain);

  // Adds a mark and returns its id. Without a colour, the mark gets the person's own colour. If the
  // board is full, it erases the oldest hidden mark. Returns FAILED_PRECONDITION if the board is
  // full and all its marks are shown.
  absl::StatusOr<std::uint64_t> Add(std::uint64_t person_id, std::vector<glm::dvec3> positions_m,
                                    const std::optional<glm::vec3>& color,
                                    const std::string& owner_key = "");
  // Gives the marks with that key to the person, who has come back with another id.
  void HandOver(const std::string& owner_key, std::uint64_t person_id);
  // Returns true if a mark in `ids` belongs to another person.
  bool HasOfOthers(const std::vector<std::uint64_t>& ids, std::uint64_t person_id) const;
  // Erases `ids`, or all shown marks if `ids` is empty. With `person_id`, erases only that person's
  // marks.
  void Erase(const std::vector<std::uint64_t>& ids, std::optional<std::uint64_t> person_id);

  // Moves the person's pointer. Without a position, removes it.
  void Point(std::uint64_t person_id, const std::optional<glm::dvec3>& position_m);

  // Returns all marks, including those of other domains.
  const std::vector<Mark>& marks() const { return marks_; }
  std::vector<Mark> MarksShown() const;
  // Returns the changes of the shown marks since the last call. Marks that were hidden since then
  // count as erased.
  MarksChange TakeMarksChange();
  // Returns the largest id of the people who drew the marks; 0 without marks.
  std::uint64_t LastPerson() const;
  const std::vector<Pointer>& pointers() const { return pointers_; }
  // These revisions count changes of the marks and of the pointers.
  std::uint64_t marks_revision() const { return marks_revision_; }
  std::uint64_t pointers_revision() const { return pointers_revision_; }

 private:
  bool IsShown(const Mark& mark) const { return mark.domain == domain_; }

  std::string domain_;  // domain of the shown storm; empty if not known
  std::vector<Mark> marks_;
  std::set<std::uint64_t> drawn_;  // ids of marks that TakeMarksChange must return as drawn
  std::vector<std::uint64_t> erased_;
  std::vector<Pointer> pointers_;
  std::uint64_t mark_count_ = 0;
  std::uint64_t marks_revision_ = 0;
  std::uint64_t pointers_revision_ = 0;
};

}  // namespace thunderhead::session
