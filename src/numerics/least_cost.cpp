#include "numerics/least_cost.hpp"

#include <exception>

namespace pcor::internal {
namespace {

/// A cost, and what it threw: NLopt lets no exception but its own through.
struct Guarded {
  const Cost& cost;
  std::exception_ptr thrown{};
};

double guarded_cost(const std::vector<double>& x, std::vector<double>&, void* data) {
  auto& guarded = *static_cast<Guarded*>(data);
  try {
    return guarded.cost(x);
  } catch (...) {
    guarded.thrown = std::current_exception();
    throw nlopt::forced_stop();
  }
}

}  // namespace

void minimize_objective(nlopt::opt& search, const Cost& cost, std::vector<double>& x) {
  Guarded guarded{cost};
  search.set_min_objective(guarded_cost, &guarded);
  double minimum = 0.0;
  try {
    search.optimize(x, minimum);
  } catch (const nlopt::roundoff_limited&) {
    // The best point so far is used.
  } catch (const nlopt::forced_stop&) {
    std::rethrow_exception(guarded.thrown);
  }
}

}  // namespace pcor::internal
