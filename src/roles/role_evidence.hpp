#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/roles/role_candidate.hpp>

namespace pcor::internal {

/// Minimum score at which a candidate is accepted if no other has a similar score.
inline constexpr double sure_score = 0.85;
/// Minimum difference to the score of the second candidate.
inline constexpr double clear_lead = 0.015;

/// For each role, and each series that no model reads, the candidate variables of a flight, sorted by
/// decreasing score: by CF's standard_name, by words of the name and of the long_name, by a convertible unit
/// and by typical values. Variables with another unit or with values out of range are not candidates.
std::map<std::string, std::vector<RoleCandidate>> role_candidates(const Flight& flight);

/// The candidates for one series; reads only variables with words of that series.
std::vector<RoleCandidate> role_candidates(const Flight& flight, std::string_view series);

/// Whether the first of these is sure, and clear of the second.
bool is_sure(const std::vector<RoleCandidate>& candidates);

/// The first candidate for a series if it is sure; otherwise empty.
std::string sure_variable(const Flight& flight, std::string_view series);

/// The words of a name or a text, small, with usual abbreviations written out: "wgs_alt" is wgs altitude.
std::vector<std::string> plain_words(std::string_view text);

}  // namespace pcor::internal
