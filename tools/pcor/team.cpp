#include "team.hpp"

namespace pcor::tool {
namespace {

Team*& team_of_this_run() {
  static Team* team = &alone();
  return team;
}

}  // namespace

Team& team() { return *team_of_this_run(); }

void set_team(Team& team) { team_of_this_run() = &team; }

bool is_speaker() { return team().rank() == 0; }

}  // namespace pcor::tool
