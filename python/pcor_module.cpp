#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/batch/batch.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/realtime/loop.hpp>
#include <pcor/units/units.hpp>

namespace py = pybind11;

namespace pcor {
namespace {

/// Contiguous doubles of any shape. pybind11 does not copy an array that has this form.
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

CorrectWith correct_with(const std::string& name) {
  if (name == "model") return CorrectWith::model;
  if (name == "lams") return CorrectWith::lams;
  throw Error(Error::Code::usage, "correct_with: unknown value '" + name + "' (expected 'model' or 'lams')");
}

Quantity known_quantity(const std::string& name) {
  const Quantity quantity = quantity_named(name);
  if (quantity == Quantity::count) {
    throw Error(Error::Code::variable, "there is no quantity '" + name + "'; pcor.quantities lists them");
  }
  return quantity;
}

/// Quantities among the names. Other names belong to variables of formulas.
std::vector<Quantity> quantities_among(const std::vector<std::string>& names) {
  std::vector<Quantity> quantities;
  for (const std::string& name : names) {
    const Quantity quantity = quantity_named(name);
    if (quantity != Quantity::count) quantities.push_back(quantity);
  }
  return quantities;
}

/// Quantity of a recorded input: the formula variable `name`, otherwise the quantity `name`.
/// @throws Error if there is neither
Quantity input_named(const std::string& name, const std::vector<std::string>& extra_names) {
  const auto extra = std::find(extra_names.begin(), extra_names.end(), name);
  if (extra != extra_names.end())
    return extra_quantity(static_cast<std::size_t>(extra - extra_names.begin()));
  return known_quantity(name);
}

std::string name_of(Quantity quantity, const std::vector<std::string>& extra_names) {
  if (index(quantity) < quantity_count) return std::string(info_of(quantity).name);
  return extra_names[extra_number(quantity)];
}

/// Default results of arrays.
constexpr std::array default_results{
    Quantity::static_defect,      Quantity::corrected_static_pressure, Quantity::corrected_dynamic_pressure,
    Quantity::corrected_mach,     Quantity::ambient_temperature,       Quantity::corrected_airspeed,
    Quantity::lams_static_defect, Quantity::lams_temperature,          Quantity::lams_dynamic_pressure};

/// Model evaluated on arrays.
class ArrayModel {
 public:
  ArrayModel(const ModelDefinition& model, const std::vector<std::string>& recorded, const std::string& with)
      : batch_(model.model, quantities_among(recorded), correct_with(with)) {}

  std::vector<std::string> inputs() const {
    std::vector<std::string> names;
    for (const Quantity input : batch_.chain().inputs()) names.push_back(name_of(input, extra_names()));
    return names;
  }

  /// Default results that the inputs determine.
  std::vector<std::string> outputs() const {
    std::vector<std::string> names;
    for (const Quantity output : default_results) {
      if (batch_.finds(output)) names.emplace_back(info_of(output).name);
    }
    return names;
  }

  std::map<std::string, Array> run(const std::map<std::string, Array>& arrays,
                                   const std::vector<std::string>& requested,
                                   const std::map<std::string, Array>& out) const {
    std::vector<py::ssize_t> shape;
    std::vector<Batch::Input> inputs;
    for (const auto& [name, array] : arrays) {
      const std::vector<py::ssize_t> own(array.shape(), array.shape() + array.ndim());
      if (inputs.empty()) shape = own;
      if (own != shape) {
        throw Error(Error::Code::usage, "the array of '" + name + "' has another shape than that of '" +
                                            arrays.begin()->first +
                                            "'; give all recorded quantities on the same samples");
      }
      inputs.push_back({input_named(name, extra_names()), array.data()});
    }
    std::size_t samples = 1;
    for (const py::ssize_t extent : shape) samples *= static_cast<std::size_t>(extent);
    std::map<std::string, Array> results;
    std::vector<Batch::Output> outputs;
    for (const std::string& name : requested) {
      const auto given = out.find(name);
      const auto [result, is_new] = results.emplace(name, given == out.end() ? Array(shape) : given->second);
      if (is_new) outputs.push_back({known_quantity(name), result->second.mutable_data()});
    }
    {
      const py::gil_scoped_release others_run;
      batch_.run(inputs, outputs, samples);
    }
    return results;
  }

 private:
  const std::vector<std::string>& extra_names() const { return batch_.chain().extra_names(); }

  Batch batch_;
};

/// Sample loop with named inputs and results.
class NamedLoop {
 public:
  NamedLoop(const ModelDefinition& model, const std::vector<std::string>& recorded, double rate,
            const std::string& with)
      : loop_(built(model, recorded, rate, with)) {
    for (const std::string& name : recorded) inputs_.push_back(input_named(name, loop_.extra_names()));
    for (const QuantityInfo& info : quantity_info) {
      const bool is_result = loop_.writes(info.quantity) ||
                             std::find(inputs_.begin(), inputs_.end(), info.quantity) != inputs_.end();
      if (is_result) shown_.push_back(info.quantity);
    }
  }

  /// Inputs that are not given are missing.
  py::dict run(double time, const std::map<std::string, double>& values) {
    State<double>& state = loop_.state();
    for (const Quantity input : inputs_) state[input] = missing<double>();
    for (const auto& [name, value] : values) {
      const Quantity quantity = input_named(name, loop_.extra_names());
      if (std::find(inputs_.begin(), inputs_.end(), quantity) == inputs_.end()) {
        throw Error(Error::Code::variable,
                    "'" + name + "' is not a recorded quantity of this loop; add it to `recorded`");
      }
      state[quantity] = value;
    }
    loop_.run(time);
    py::dict results;
    for (const Quantity quantity : shown_) {
      results[py::str(std::string(info_of(quantity).name))] = state[quantity];
    }
    results["time"] = state[Quantity::time];
    results["quality"] = loop_.quality().bits();
    return results;
  }

  std::size_t delay() const { return loop_.delay(); }
  void reset() { loop_.reset(); }

 private:
  static Loop built(const ModelDefinition& model, const std::vector<std::string>& recorded, double rate,
                    const std::string& with) {
    std::string error;
    std::optional<Loop> loop = Loop::build(model.model, quantities_among(recorded), rate, &error,
                                           correct_with(with), uncertainty_of(model));
    if (!loop) throw Error(Error::Code::model, "model '" + model.model.name + "': " + error);
    return std::move(*loop);
  }

  Loop loop_;
  std::vector<Quantity> inputs_;
  std::vector<Quantity> shown_;
};

/// Coefficients by name, such as "static-qp.a2".
std::map<std::string, double> parameters_of(const ModelDefinition& model) {
  std::map<std::string, double> values;
  for (const ModelEffect& effect : model.model.effects) {
    const std::vector<std::string> names = parameter_names(effect);
    for (std::size_t i = 0; i < names.size(); ++i) values[effect.id + "." + names[i]] = effect.parameters[i];
  }
  return values;
}

ModelDefinition with_parameters(ModelDefinition model, const std::map<std::string, double>& values) {
  const std::map<std::string, double> known = parameters_of(model);
  for (const auto& [name, value] : values) {
    if (known.count(name) == 0) {
      throw Error(Error::Code::model, "model '" + model.model.name + "' has no coefficient '" + name +
                                          "'; names have the form 'static-qp.a2'");
    }
  }
  for (ModelEffect& effect : model.model.effects) {
    const std::vector<std::string> names = parameter_names(effect);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto value = values.find(effect.id + "." + names[i]);
      if (value != values.end()) effect.parameters[i] = value->second;
    }
  }
  return model;
}

std::map<std::string, std::string> by_role(const std::map<Quantity, std::string>& texts) {
  std::map<std::string, std::string> named;
  for (const auto& [role, text] : texts) named.emplace(info_of(role).name, text);
  return named;
}

/// Converts errors of the library to `pcor.Error`.
void translate(std::exception_ptr error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const Error& failure) {
    const py::object type = py::module_::import("pcor._error").attr("Error");
    const py::object raised = type(failure.what(), std::string(to_string(failure.code())));
    PyErr_SetObject(type.ptr(), raised.ptr());
  }
}

}  // namespace
}  // namespace pcor

PYBIND11_MODULE(_pcor, module) {
  using namespace pcor;
  module.attr("version") = PCOR_VERSION;
  py::dict quantities;
  for (const QuantityInfo& info : quantity_info) {
    quantities[py::str(std::string(info.name))] =
        py::make_tuple(std::string(info.unit), std::string(info.description), is_role(info.quantity));
  }
  module.attr("quantities") = quantities;
  py::dict quality;
  for (const QualityInfo& info : quality_info) {
    quality[py::str(std::string(info.name))] =
        py::make_tuple(static_cast<std::uint32_t>(info.bit), std::string(info.meaning));
  }
  module.attr("quality") = quality;
  py::register_exception_translator(&translate);

  py::class_<ModelDefinition>(module, "ModelDefinition")
      .def_static("read", [](const std::string& path) { return read_model(path); })
      .def_static("parse",
                  [](const std::string& text, const std::string& name) { return parse_model(text, name); })
      .def("text", &write_model)
      .def("save", [](const ModelDefinition& model, const std::string& path) { save_model(model, path, {}); })
      .def("with_parameters", &with_parameters)
      .def_property_readonly("name", [](const ModelDefinition& model) { return model.model.name; })
      .def_property_readonly("variables",
                             [](const ModelDefinition& model) { return by_role(model.variables); })
      .def_property_readonly("units", [](const ModelDefinition& model) { return by_role(model.units); })
      .def_property_readonly("parameters", &parameters_of);

  py::class_<ArrayModel>(module, "ArrayModel")
      .def(py::init<const ModelDefinition&, const std::vector<std::string>&, const std::string&>())
      .def_property_readonly("inputs", &ArrayModel::inputs)
      .def_property_readonly("outputs", &ArrayModel::outputs)
      .def("run", &ArrayModel::run);

  py::class_<NamedLoop>(module, "NamedLoop")
      .def(py::init<const ModelDefinition&, const std::vector<std::string>&, double, const std::string&>())
      .def("run", &NamedLoop::run)
      .def("reset", &NamedLoop::reset)
      .def_property_readonly("delay", &NamedLoop::delay);

  module.def("conversion", [](const std::string& from, const std::string& to, const std::string& variable) {
    const UnitConversion conversion = UnitConversion::between(from, to, {variable, "", ""});
    return std::make_pair(conversion.scale(), conversion.offset());
  });
}
