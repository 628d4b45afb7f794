#include "access/rules.h"

#include <algorithm>
#include <array>

namespace thunderhead::access {
namespace {

struct Rule {
  std::string_view method;
  bool viewer;
  bool presenter;
  bool pipeline;
};

// An operator may call every method in this list.
constexpr std::array kRules = {
    Rule{"GetServerInfo", true, true, true},
    Rule{"ListStorms", true, true, true},
    Rule{"DescribeStorm", true, true, true},
    Rule{"GetStormMap", true, true, true},
    Rule{"ProbeRay", true, true, true},
    Rule{"Interact", true, true, false},
    Rule{"WatchFrames", true, true, false},
    Rule{"AcknowledgeFrame", true, true, false},
    Rule{"CreateSession", false, true, false},
    Rule{"UpdateScene", false, true, false},
    Rule{"CloseSession", false, true, false},
    Rule{"GenerateCloud", false, true, false},
    Rule{"DeleteCloud", false, true, false},
    Rule{"RenderImage", false, true, true},
    Rule{"RenderImageWithProgress", false, true, true},
    Rule{"CreateRenderJob", false, true, true},
    Rule{"GetRenderJob", false, true, true},
    Rule{"ListRenderJobs", false, true, true},
    Rule{"WatchRenderJob", false, true, true},
    Rule{"CancelRenderJob", false, true, true},
    Rule{"FetchRenderResult", false, true, true},
};

const Rule* Find(std::string_view method) {
  const auto* const rule = std::ranges::find(kRules, method, &Rule::method);
  return rule == kRules.end() ? nullptr : rule;
}

}  // namespace

bool MayCall(Role role, std::string_view method) {
  const Rule* rule = Find(method);
  if (rule == nullptr) return false;
  switch (role) {
    case Role::kViewer:
      return rule->viewer;
    case Role::kPresenter:
      return rule->presenter;
    case Role::kPipeline:
      return rule->pipeline;
    case Role::kOperator:
      return true;
  }
  return false;
}

bool HasRule(std::string_view method) { return Find(method) != nullptr; }

bool MayPresent(Role role) { return role == Role::kPresenter || role == Role::kOperator; }

}  // namespace thunderhead::access
