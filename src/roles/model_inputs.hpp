#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/realtime/chain.hpp>

namespace pcor::internal {

/// A variable of a flight that a model reads, and the quantity that it is.
struct ModelInput {
  std::string variable;
  Quantity quantity = Quantity::count;
  UnitConversion conversion;
};

/// The roles of a model, without that of the laser where its reading is not wanted.
std::vector<Quantity> roles_of(const ModelDefinition& file, bool with_laser);

/// The chain of a model on these roles. @throws Error if the model cannot be used on them.
Chain chain_of(const Model& model, const std::vector<Quantity>& roles);

/// What `chain`, which was built for the roles `roles` of `file`, reads of `flight`: the variables of the
/// roles, and those that formulas name. Adds to `notes` what a user should know, a sentence each.
/// @throws Error if a variable is absent or has no value, or its unit does not fit.
std::vector<ModelInput> model_inputs(const Flight& flight, const ModelDefinition& file, const Chain& chain,
                                     const std::vector<Quantity>& roles, std::vector<std::string>& notes);

/// Adds to `notes` how many samples of an input are taken as missing though the file does not mark them so,
/// and why; nothing where there are none.
void note_left_out(const ModelInput& input, const RejectedCounts& left_out, std::vector<std::string>& notes);

/// What a user should know of a law that was made for another time or aircraft than the flight's.
std::vector<std::string> notes_on_law(const Flight& flight, const ModelDefinition& file);

/// Whether a model is of the flight's aircraft, by the registration, which stands in both: "C-130 N130AR" and
/// "N130AR". False where one of them does not say.
bool is_of_aircraft(const ModelDefinition& file, const Flight& flight);

}  // namespace pcor::internal
