#pragma once

#include <string>
#include <vector>

#include <pcor/base/note.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/realtime/chain.hpp>

namespace pcor::internal {

/// Source of a model that `inspect_flight` makes; its fits are to the variables of the flight.
inline constexpr const char* source_without_law = "no law yet: all coefficients are zero until a refit";

/// The pressures of a model, as a refit writes them to its provenance.
ProvenanceList fitted_pressures(const ModelDefinition& file);

/// A variable of a flight that a model reads, and the quantity that it is.
struct ModelInput {
  std::string variable;
  Quantity quantity = Quantity::count;
  UnitConversion conversion;
};

/// The roles of a model, without that of the laser where its reading is not requested.
std::vector<Quantity> roles_of(const ModelDefinition& file, bool with_laser);

/// The chain of a model on these roles. @throws Error if the model cannot be used on them.
Chain chain_of(const Model& model, const std::vector<Quantity>& roles);

/// Inputs of `flight` for `chain`, which was built for the roles `roles` of `file`: the variables of the
/// roles and of formulas. Adds cautions to `notes`, one sentence each.
/// @throws Error if a variable is absent or has no value, or its unit does not fit.
std::vector<ModelInput> model_inputs(const Flight& flight, const ModelDefinition& file, const Chain& chain,
                                     const std::vector<Quantity>& roles, Notes& notes);

/// Adds to `notes` each role whose unit in the file is replaced by that of the model.
void note_other_units(const Flight& flight, const ModelDefinition& file, Notes& notes);

/// Adds to `notes` the number of samples of an input that are treated as missing without a mark in the file,
/// and the reason; no note without such samples.
void note_excluded(const ModelInput& input, const RejectedCounts& excluded, Notes& notes);

/// Cautions about a law that was made for another time or aircraft than the flight.
Notes notes_on_law(const Flight& flight, const ModelDefinition& file);

/// Whether a model belongs to the flight's aircraft: both state the same registration, as "C-130 N130AR" and
/// "N130AR" do. "C-130" alone is not the aircraft "C-130 N130AR". Without a registration of a known form in
/// both, one text is the other or its last word.
bool is_of_aircraft(const ModelDefinition& file, const Flight& flight);

}  // namespace pcor::internal
