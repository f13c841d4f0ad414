#pragma once

#include <pcor/team/team.hpp>

namespace pcor::tool {

/// The team that this process works in: itself alone, unless `set_team` said otherwise.
Team& team();
void set_team(Team& team);

/// Whether this member of the team says and writes what comes of the work: the first does, for all.
bool is_speaker();

}  // namespace pcor::tool
