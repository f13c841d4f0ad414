#pragma once

#include <array>
#include <cstddef>
#include <vector>

/// A plain model of how NCAR's nimbus derives variables: a table of functions, each of which fetches its
/// inputs by index, computes all it needs from them anew, and puts its output by index. The gas constants are
/// globals, set by one function and used by others. No code of nimbus is in it. It is quicker than nimbus,
/// whose functions take 1.2 times as long in its own loop, as they are compiled apart: a ratio to it is no
/// flattery.
namespace nimbus_model {

enum Variable : std::size_t {
  PSX,
  QCX,
  TTX,
  EWX,
  AKRD,
  PSXC,
  QCXC,
  MACHX,
  TASFLG,
  ATX,
  TASX,
  PCOR,
  variable_count
};

/// The values of one sample.
using Sample = std::array<double, variable_count>;

/// A derived variable: the function that computes it, where its inputs are, where its output goes.
struct Derivation {
  void (*compute)(const Derivation&, Sample&);
  std::vector<std::size_t> inputs;
  std::size_t output;
};

/// Corrected static and dynamic pressure, Mach number, humidity, ambient temperature and true airspeed, in
/// the order in which they depend on each other.
std::vector<Derivation> chain();

}  // namespace nimbus_model
