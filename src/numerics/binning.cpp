#include "numerics/binning.hpp"

#include <algorithm>
#include <cmath>

namespace pcor::internal {

Binning::Binning(const std::vector<double>& residual, const std::vector<double>& time, double step,
                 double width) {
  if (time.empty()) return;
  width_ = std::max(1.0, std::round(width / step)) * step;
  const double fewest = 0.5 * width_ / step;
  std::vector<double> counts;
  long before = -2;  // number of the cell of the last bin
  for (std::size_t i = 0; i < residual.size();) {
    const auto cell = static_cast<long>(std::floor((time[i] - time.front()) / width_));
    std::vector<std::size_t> members;
    double middle = 0.0;
    for (; i < residual.size() && static_cast<long>(std::floor((time[i] - time.front()) / width_)) == cell;
         ++i) {
      if (std::isnan(residual[i])) continue;
      members.push_back(i);
      middle += time[i];
    }
    const auto count = static_cast<double>(members.size());
    if (members.empty() || count < fewest) continue;
    if (cell != before + 1) segments_.push_back({time_.size(), 0});
    before = cell;
    ++segments_.back().count;
    for (const std::size_t member : members) {
      record_.push_back(member);
      bin_.push_back(static_cast<Eigen::Index>(time_.size()));
    }
    time_.push_back(middle / count);
    counts.push_back(count);
  }
  count_ = Eigen::Map<const Eigen::VectorXd>(counts.data(), static_cast<Eigen::Index>(counts.size()));
}

}  // namespace pcor::internal
