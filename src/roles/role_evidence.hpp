#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/flight/flight.hpp>

namespace pcor::internal {

/// A variable that may play a role, by what its file says of it.
struct RoleCandidate {
  std::string variable{};
  double score = 0.0;  ///< 0 to 1: the more speaks for it, the more
  std::string why{};   ///< "its name is 'static pressure', in hPa, with 560 to 960"
};

/// From here on a candidate is taken where no other comes near.
inline constexpr double sure_score = 0.85;
/// How much the second has to stay behind, so that the first is no guess between two.
inline constexpr double clear_lead = 0.015;

/// For each role, and each series that no model reads, the variables of a flight that may play it, the
/// likeliest first: by CF's standard_name, by words of the name and of the long_name, by a unit that fits,
/// and by values that are those of such a series. What has a unit that does not fit, or values out of range,
/// is none.
std::map<std::string, std::vector<RoleCandidate>> role_candidates(const Flight& flight);

/// The candidates for one series; reads only variables with words of that series.
std::vector<RoleCandidate> role_candidates(const Flight& flight, std::string_view series);

/// Whether the first of these is sure, and clear of the second.
bool is_sure(const std::vector<RoleCandidate>& candidates);

/// The words of a name or a text, small, with usual abbreviations written out: "wgs_alt" is wgs altitude.
std::vector<std::string> plain_words(std::string_view text);

}  // namespace pcor::internal
