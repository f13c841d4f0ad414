#include <pcor/realtime/nimbus.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>

namespace {

using pcor::Loop;
using pcor::Model;
using pcor::NimbusSystem;
using pcor::Quality;
using pcor::Quantity;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::IsNan;

// A small stand-in for nimbus: its globals, its table, its two records of floats.

enum FeedBackType { low_rate_feedback, high_rate_feedback };

constexpr std::size_t high_rate = 25;

FeedBackType FeedBack = low_rate_feedback;
std::size_t SampleOffset = 0;
double Second = 0.0;

struct DERTBL {
  std::string name;
  std::vector<std::string> depends;
  void (*compute)(DERTBL*);
  std::vector<std::size_t> inputs{};  // indices in the record
  std::size_t output = 0;
};

// Values of each variable: one at the low rate and one second of values at the high rate.
struct Values {
  float low;
  float high[high_rate];
};
std::vector<Values> record;

float& sample(std::size_t position) {
  return FeedBack == low_rate_feedback ? record[position].low : record[position].high[SampleOffset];
}

double sample_time() { return Second + static_cast<double>(SampleOffset) / static_cast<double>(high_rate); }

struct Host {
  using Entry = DERTBL;
  static double get(Entry* entry, std::size_t input) {
    return static_cast<double>(sample(entry->inputs.at(input)));
  }
  static void put(Entry* entry, double value) { sample(entry->output) = static_cast<float>(value); }
  static bool high_rate() { return FeedBack == high_rate_feedback; }
  static double time() { return sample_time(); }
};

class Table {
 public:
  Table(const std::vector<std::string>& raw, std::vector<DERTBL> derived) : derived_(std::move(derived)) {
    record.clear();
    for (const std::string& name : raw) add(name);
    for (DERTBL& entry : derived_) entry.output = add(entry.name);
    for (DERTBL& entry : derived_) {
      for (const std::string& name : entry.depends) entry.inputs.push_back(indices_.at(name));
    }
    for (DERTBL& entry : derived_) visit(entry);
  }

  // Values of the raw variables in `second`, as a function of name and time.
  template <class Raw>
  void compute(double second, Raw raw) {
    Second = second;
    for (const FeedBackType rate : {low_rate_feedback, high_rate_feedback}) {
      FeedBack = rate;
      for (SampleOffset = 0; SampleOffset < (rate == low_rate_feedback ? 1 : high_rate); ++SampleOffset) {
        for (const auto& [name, position] : indices_) {
          if (!is_derived(name)) sample(position) = raw(name, sample_time());
        }
        for (DERTBL* entry : compute_order_) entry->compute(entry);
      }
    }
    SampleOffset = 0;
  }

  float low(const std::string& name) const { return record[indices_.at(name)].low; }
  float high(const std::string& name, std::size_t offset) const {
    return record[indices_.at(name)].high[offset];
  }
  DERTBL& entry(const std::string& name) { return *find(name); }

 private:
  std::size_t add(const std::string& name) {
    record.push_back({});
    return indices_[name] = record.size() - 1;
  }
  DERTBL* find(const std::string& name) {
    for (DERTBL& entry : derived_) {
      if (entry.name == name) return &entry;
    }
    return nullptr;
  }
  bool is_derived(const std::string& name) { return find(name) != nullptr; }
  void visit(DERTBL& entry) {
    if (std::find(compute_order_.begin(), compute_order_.end(), &entry) != compute_order_.end()) return;
    for (const std::string& name : entry.depends) {
      if (DERTBL* const other = find(name)) visit(*other);
    }
    compute_order_.push_back(&entry);
  }

  std::vector<DERTBL> derived_;
  std::map<std::string, std::size_t> indices_;
  std::vector<DERTBL*> compute_order_;
};

// A defaults file: a name, the number of values, the values.
class Defaults {
 public:
  explicit Defaults(const std::string& text) {
    std::istringstream lines(text);
    std::string name;
    std::size_t count = 0;
    while (lines >> name >> count) {
      values_[name].resize(count);
      for (float& value : values_[name]) lines >> value;
    }
  }
  const float* value(const char* name) const {
    const auto found = values_.find(name);
    return found == values_.end() ? nullptr : found->second.data();
  }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& [name, values] : values_) names.push_back(name);
    return names;
  }

 private:
  std::map<std::string, std::vector<float>> values_;
};

// The C-130's fuselage pair, and the radome pair with a lag of its line.

Model fuselage_model() {
  Model model;
  model.effects = {
      {"static-constant", {0.004127875}}, {"static-alpha", {0.021279816}}, {"static-qp", {0.030849643}}};
  model.recovery = {{0.95}};
  return model;
}

Model radome_model() {
  Model model;
  model.effects = {{"static-constant", {-0.0012}}, {"static-lag", {0.15}}};
  model.recovery = {{0.985}};
  return model;
}

struct FuselageTag;
struct RadomeTag;
using Fuselage = NimbusSystem<Host, FuselageTag>;
using Radome = NimbusSystem<Host, RadomeTag>;

const std::vector<std::string> raw_names{"PSFD", "QCF", "PSFRD", "QCFR", "QCR", "ADIFR", "RTF1", "DPB"};

const std::vector<std::string> fuselage_roles{"static_pressure",         "dynamic_pressure",
                                              "radome_dynamic_pressure", "attack_differential_pressure",
                                              "recovery_temperature",    "dew_point"};
const std::vector<std::string> fuselage_inputs{"PSFD", "QCF", "QCR", "ADIFR", "RTF1", "DPB"};

const std::vector<std::string> radome_roles{"recovery_temperature", "dynamic_pressure", "static_pressure"};
const std::vector<std::string> radome_inputs{"RTF1", "QCFR", "PSFRD"};

bool install_both() {
  std::string error;
  const bool installed = Fuselage::install(fuselage_model(), fuselage_roles, 1.0, 25.0, &error) &&
                         Radome::install(radome_model(), radome_roles, 1.0, 25.0, &error);
  EXPECT_EQ(error, "");
  return installed;
}

std::vector<DERTBL> both_systems() {
  return {
      {"PSXC", {"PCOR"}, Fuselage::fetch<Quantity::corrected_static_pressure>},
      {"QCXC", {"PCOR"}, Fuselage::fetch<Quantity::corrected_dynamic_pressure>},
      {"MACHX", {"PCOR"}, Fuselage::fetch<Quantity::corrected_mach>},
      {"ATX", {"PCOR"}, Fuselage::fetch<Quantity::ambient_temperature>},
      {"TASX", {"PCOR"}, Fuselage::fetch<Quantity::corrected_airspeed>},
      {"PCORFLAG", {"PCOR"}, Fuselage::fetch_quality},
      {"PCOR", fuselage_inputs, Fuselage::compute},
      {"PSXC_R", {"PCOR_R"}, Radome::fetch<Quantity::corrected_static_pressure>},
      {"TASX_R", {"PCOR_R"}, Radome::fetch<Quantity::corrected_airspeed>},
      {"PCORFLAG_R", {"PCOR_R"}, Radome::fetch_quality},
      {"PCOR_R", radome_inputs, Radome::compute},
  };
}

// Climbs with pitch oscillations; temperatures in degC.
float raw_value(const std::string& name, double time) {
  const auto wave = [time](double mean, double size, double period) {
    return static_cast<float>(mean + size * std::sin(6.283185307179586 * time / period));
  };
  if (name == "PSFD") return wave(700.0 - 0.6 * std::fmod(time, 100.0), 2.0, 31.0);
  if (name == "PSFRD") return wave(701.2 - 0.6 * std::fmod(time, 100.0), 2.0, 31.0);
  if (name == "QCF") return wave(67.6, 3.0, 17.0);
  if (name == "QCFR") return wave(66.8, 3.0, 17.0);
  if (name == "QCR") return wave(67.1, 3.0, 17.0);
  if (name == "ADIFR") return wave(-15.0, 6.0, 9.0);
  if (name == "RTF1") return wave(8.0, 0.5, 23.0);
  return wave(-3.0, 2.0, 13.0);
}

Loop plain(const Model& model, const std::vector<std::string>& roles, double rate) {
  std::vector<Quantity> recorded;
  for (const std::string& role : roles) recorded.push_back(pcor::quantity_named(role));
  std::string error;
  auto loop = Loop::build(model, recorded, rate, &error);
  if (!loop) throw std::runtime_error(error);
  return std::move(*loop);
}

// Runs one sample in a plain loop on the same floats.
template <class Raw>
void run_plain(Loop& loop, const std::vector<std::string>& roles, const std::vector<std::string>& inputs,
               double time, Raw raw) {
  for (std::size_t i = 0; i < roles.size(); ++i) {
    const Quantity role = pcor::quantity_named(roles[i]);
    const auto value = static_cast<double>(raw(inputs[i], time));
    loop.state()[role] = pcor::info_of(role).unit == "K" ? value + 273.15 : value;
  }
  loop.run(time);
}

std::uint32_t bits_of(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

void expect_same_float(float value, double expected) {
  if (std::isnan(expected)) {
    EXPECT_THAT(value, IsNan());
  } else {
    EXPECT_EQ(bits_of(value), bits_of(static_cast<float>(expected))) << value << " for " << expected;
  }
}

// `value` gives what the table has of a name.
template <class Value>
void expect_fuselage(const Loop& loop, Value value) {
  expect_same_float(value("PCOR"), loop.state()[Quantity::static_defect]);
  expect_same_float(value("PSXC"), loop.state()[Quantity::corrected_static_pressure]);
  expect_same_float(value("QCXC"), loop.state()[Quantity::corrected_dynamic_pressure]);
  expect_same_float(value("MACHX"), loop.state()[Quantity::corrected_mach]);
  expect_same_float(value("ATX"), loop.state()[Quantity::ambient_temperature] - 273.15);
  expect_same_float(value("TASX"), loop.state()[Quantity::corrected_airspeed]);
  expect_same_float(value("PCORFLAG"), loop.quality().bits());
}

template <class Value>
void expect_radome(const Loop& loop, Value value) {
  expect_same_float(value("PCOR_R"), loop.state()[Quantity::static_defect]);
  expect_same_float(value("PSXC_R"), loop.state()[Quantity::corrected_static_pressure]);
  expect_same_float(value("TASX_R"), loop.state()[Quantity::corrected_airspeed]);
  expect_same_float(value("PCORFLAG_R"), loop.quality().bits());
}

// Runs the table through `seconds` and compares every value with plain loops.
template <class Raw>
void expect_plain_loops(const std::vector<double>& seconds, Raw raw) {
  ASSERT_TRUE(install_both());
  Table table(raw_names, both_systems());
  Loop low = plain(fuselage_model(), fuselage_roles, 1.0);
  bool were_all_there = false;
  Loop high = plain(fuselage_model(), fuselage_roles, 25.0);
  Loop low_radome = plain(radome_model(), radome_roles, 1.0);
  Loop high_radome = plain(radome_model(), radome_roles, 25.0);
  for (const double second : seconds) {
    SCOPED_TRACE(second);
    table.compute(second, raw);
    const auto low_value = [&](const char* name) { return table.low(name); };
    run_plain(low, fuselage_roles, fuselage_inputs, second, raw);
    expect_fuselage(low, low_value);
    run_plain(low_radome, radome_roles, radome_inputs, second, raw);
    expect_radome(low_radome, low_value);
    for (std::size_t offset = 0; offset < high_rate; ++offset) {
      SCOPED_TRACE(offset);
      const double time = second + static_cast<double>(offset) / static_cast<double>(high_rate);
      const auto high_value = [&](const char* name) { return table.high(name, offset); };
      run_plain(high, fuselage_roles, fuselage_inputs, time, raw);
      expect_fuselage(high, high_value);
      run_plain(high_radome, radome_roles, radome_inputs, time, raw);
      expect_radome(high_radome, high_value);
    }
    were_all_there |= !std::isnan(table.low("TASX") + table.high("TASX", 24) + table.low("TASX_R"));
  }
  EXPECT_TRUE(were_all_there) << "there is something to compare";
}

std::vector<double> seconds(double from, double to) {
  std::vector<double> result;
  for (double second = from; second < to; ++second) result.push_back(second);
  return result;
}

TEST(NimbusSystem, TwoSystemsMatchPlainLoopsAtBothRates) {
  expect_plain_loops(seconds(36000.0, 36040.0), raw_value);
}

TEST(NimbusSystem, MissingSamplesGiveTheSameAsPlainLoops) {
  expect_plain_loops(seconds(0.0, 20.0), [](const std::string& name, double time) {
    const bool lost = (name == "RTF1" && std::fmod(time, 7.0) < 1.3) ||
                      (name == "PSFRD" && std::fmod(time, 5.0) < 0.5) ||
                      (name == "QCF" && std::fmod(time, 3.0) < 0.2);
    return lost ? std::numeric_limits<float>::quiet_NaN() : raw_value(name, time);
  });
}

TEST(NimbusSystem, RestartsTheStateOfEachRateAfterAGap) {
  std::vector<double> with_gap = seconds(100.0, 110.0);
  for (const double second : seconds(113.0, 122.0)) with_gap.push_back(second);
  expect_plain_loops(with_gap, raw_value);
}

TEST(NimbusSystem, EachSampleRateHasItsOwnRateOfChange) {
  ASSERT_TRUE(install_both());
  Table table(raw_names, both_systems());
  // The pressure falls 1 hPa a second, and by steps: the effect of the radome pair's lag of 0.15 s shows the
  // rate.
  const auto falling = [](const std::string& name, double time) {
    return name == "PSFRD" ? static_cast<float>(700.0 - time) : raw_value(name, 0.0);
  };
  const auto lag = [](float corrected, double measured, float defect) {
    return static_cast<double>(corrected) - measured - static_cast<double>(defect);
  };
  // The output is six samples old at the low rate, and three seconds old at the high one.
  const auto dry = static_cast<float>(Quality::dry_air_assumed);
  for (double second = 0.0; second < 30.0; second += second == 14.0 ? 5.0 : 1.0) {
    SCOPED_TRACE(second);
    table.compute(second, falling);
    FeedBack = low_rate_feedback;
    EXPECT_EQ(Radome::delay(), 6U);
    FeedBack = high_rate_feedback;
    EXPECT_EQ(Radome::delay(), 75U);
    const double since = second < 15.0 ? second : second - 19.0;  // the last gap
    if (since < 6.0) {
      EXPECT_THAT(table.low("PSXC_R"), IsNan());
      const double restart = second == 19.0 ? static_cast<double>(Quality::after_gap) : 0.0;
      EXPECT_EQ(table.low("PCORFLAG_R"), static_cast<double>(Quality::awaiting_later_samples) + restart);
    } else {
      EXPECT_NEAR(lag(table.low("PSXC_R"), 706.0 - second, table.low("PCOR_R")), -0.15, 1e-4);
      EXPECT_EQ(table.low("PCORFLAG_R"), dry);
    }
    if (since < 3.0) {
      EXPECT_THAT(table.high("PSXC_R", 10), IsNan());
    } else {
      EXPECT_NEAR(lag(table.high("PSXC_R", 10), 703.0 - second - 0.4, table.high("PCOR_R", 10)), -0.15, 1e-3);
      EXPECT_EQ(table.high("PCORFLAG_R", 10), dry);
    }
  }
}

TEST(NimbusSystem, TemperaturesAreInCelsius) {
  ASSERT_TRUE(install_both());
  Table table(raw_names, both_systems());
  table.compute(0.0, [](const std::string& name, double) {
    return name == "RTF1" ? 8.0F : name == "DPB" ? -3.0F : raw_value(name, 0.0);
  });
  const double mach = static_cast<double>(table.low("MACHX"));
  EXPECT_NEAR(static_cast<double>(table.low("ATX")), 281.15 / (1.0 + 0.95 * 0.2 * mach * mach) - 273.15,
              0.02);
}

TEST(NimbusSystem, GivesUncertaintiesAsDifferences) {
  pcor::ModelUncertainty uncertainty;
  uncertainty.random[pcor::index(Quantity::recovery_temperature)] = 0.1;
  std::string error;
  using System = NimbusSystem<Host, struct UncertainTag>;
  ASSERT_TRUE(System::install(fuselage_model(), fuselage_roles, 1.0, 25.0, &error, pcor::CorrectWith::model,
                              uncertainty))
      << error;
  Table table(raw_names, {{"PCOR", fuselage_inputs, System::compute},
                          {"ATX_U", {"PCOR"}, System::fetch<Quantity::ambient_temperature_uncertainty>}});
  table.compute(0.0, raw_value);
  // A thermometer error equals the temperature error except for the dynamic heating of a few per cent.
  EXPECT_NEAR(static_cast<double>(table.low("ATX_U")), 0.1, 0.005);
}

TEST(NimbusSystem, WritesNoValueBeforeTheFirstRun) {
  ASSERT_TRUE(install_both());
  Table table(raw_names, both_systems());
  Second = 0.0;
  FeedBack = low_rate_feedback;
  table.entry("PCORFLAG").compute(&table.entry("PCORFLAG"));
  EXPECT_THAT(table.low("PCORFLAG"), IsNan());
}

TEST(NimbusSystem, EarlierSampleIsNotReturned) {
  ASSERT_TRUE(install_both());
  Table table(raw_names, both_systems());
  table.compute(0.0, raw_value);
  EXPECT_FALSE(std::isnan(table.low("PSXC")));
  Second = 1.0;
  FeedBack = low_rate_feedback;
  for (const char* name : {"PSXC", "PCORFLAG"}) {
    table.entry(name).compute(&table.entry(name));
    EXPECT_THAT(table.low(name), IsNan()) << "the leader has not run for this second";
  }
}

TEST(NimbusSystem, EntryBeforeTheLeaderHasNoValue) {
  // Its values would be those of the sample before, at every sample but the first.
  ASSERT_TRUE(install_both());
  Table table(raw_names, {{"PSXC", {}, Fuselage::fetch<Quantity::corrected_static_pressure>},
                          {"PCORFLAG", {}, Fuselage::fetch_quality},
                          {"PCOR", fuselage_inputs, Fuselage::compute},
                          {"MACHX", {"PCOR"}, Fuselage::fetch<Quantity::corrected_mach>}});
  for (const double second : seconds(0.0, 3.0)) {
    table.compute(second, raw_value);
    for (const char* name : {"PSXC", "PCORFLAG"}) {
      EXPECT_THAT(table.low(name), IsNan());
      EXPECT_THAT(table.high(name, 20), IsNan());
    }
    EXPECT_FALSE(std::isnan(table.low("MACHX")));
  }
}

TEST(NimbusSystem, SeveralEntriesCanHaveTheSameResult) {
  ASSERT_TRUE(install_both());
  Table table(raw_names, {{"PCOR", fuselage_inputs, Fuselage::compute},
                          {"PSXC", {"PCOR"}, Fuselage::fetch<Quantity::corrected_static_pressure>},
                          {"PSX", {"PCOR"}, Fuselage::fetch<Quantity::corrected_static_pressure>}});
  for (const double second : seconds(0.0, 3.0)) {
    table.compute(second, raw_value);
    EXPECT_FALSE(std::isnan(table.low("PSXC")));
    EXPECT_EQ(table.low("PSX"), table.low("PSXC"));
    EXPECT_EQ(table.high("PSX", 24), table.high("PSXC", 24));
  }
}

TEST(NimbusSystem, EarlierSampleResultReachesNoOtherEntry) {
  ASSERT_TRUE(install_both());
  Table table(raw_names, {{"PCOR", fuselage_inputs, Fuselage::compute},
                          {"PSXC", {"PCOR"}, Fuselage::fetch<Quantity::corrected_static_pressure>},
                          {"PSX", {"PCOR"}, Fuselage::fetch<Quantity::corrected_static_pressure>}});
  table.compute(0.0, raw_value);
  ASSERT_FALSE(std::isnan(table.low("PSX")));
  // Samples for which the leader does not run: no entry has a value, however often they are called.
  for (int sample = 0; sample < 3; ++sample) {
    for (const char* name : {"PSXC", "PSX"}) {
      DERTBL& entry = table.entry(name);
      entry.compute(&entry);
      EXPECT_TRUE(std::isnan(table.high(name, 0))) << name << " in sample " << sample;
    }
  }
}

// A host that provides no time.
struct Timeless {
  using Entry = DERTBL;
  static double get(Entry* entry, std::size_t input) { return Host::get(entry, input); }
  static void put(Entry* entry, double value) { Host::put(entry, value); }
  static bool high_rate() { return Host::high_rate(); }
};

TEST(NimbusSystem, HostWithoutTimeIsTimedBySampleCount) {
  using System = NimbusSystem<Timeless, struct TimelessTag>;
  std::string error;
  ASSERT_TRUE(System::install(radome_model(), radome_roles, 1.0, 25.0, &error)) << error;
  ASSERT_TRUE(install_both());
  Table table(raw_names, {{"PCOR", radome_inputs, System::compute},
                          {"PSXC", {"PCOR"}, System::fetch<Quantity::corrected_static_pressure>},
                          {"PCOR_R", radome_inputs, Radome::compute},
                          {"PSXC_R", {"PCOR_R"}, Radome::fetch<Quantity::corrected_static_pressure>}});
  for (const double second : seconds(36000.0, 36012.0)) {
    table.compute(second, raw_value);
    expect_same_float(table.low("PSXC"), static_cast<double>(table.low("PSXC_R")));
    expect_same_float(table.high("PSXC", 7), static_cast<double>(table.high("PSXC_R", 7)));
  }
  EXPECT_FALSE(std::isnan(table.low("PSXC"))) << "no gap if time has no steps";
  System::reset();
  table.compute(36012.0, raw_value);
  EXPECT_THAT(table.low("PSXC"), IsNan());
}

// Each reset would return the drift to zero.
TEST(NimbusSystem, DriftIsRefusedWithoutATimeOfTheHost) {
  Model model;
  model.effects = {{"time-drift", {0.1}}};
  const std::vector<std::string> inputs{"static_pressure", "dynamic_pressure"};
  std::string error;
  EXPECT_FALSE((NimbusSystem<Timeless, struct DriftingTag>::install(model, inputs, 1.0, 25.0, &error)));
  EXPECT_THAT(error, testing::HasSubstr("time"));
  EXPECT_TRUE((NimbusSystem<Host, struct TimedTag>::install(model, inputs, 1.0, 25.0, &error))) << error;
}

TEST(NimbusSystem, ReadsTheTimeOncePerSample) {
  struct Clock {
    using Entry = DERTBL;
    static double get(Entry* entry, std::size_t input) { return Host::get(entry, input); }
    static void put(Entry* entry, double value) { Host::put(entry, value); }
    static bool high_rate() { return Host::high_rate(); }
    static double time() { return ++asked(), sample_time(); }
    static int& asked() {
      static int count = 0;
      return count;
    }
  };
  using System = NimbusSystem<Clock, struct ClockTag>;
  std::string error;
  ASSERT_TRUE(System::install(fuselage_model(), fuselage_roles, 1.0, 25.0, &error)) << error;
  Table table(raw_names, {{"PCOR", fuselage_inputs, System::compute},
                          {"PSXC", {"PCOR"}, System::fetch<Quantity::corrected_static_pressure>},
                          {"PCORFLAG", {"PCOR"}, System::fetch_quality}});
  table.compute(0.0, raw_value);
  EXPECT_EQ(Clock::asked(), 26);
}

TEST(NimbusSystem, ResetRestartsTheState) {
  ASSERT_TRUE(install_both());
  Table table(raw_names, both_systems());
  for (const double second : seconds(0.0, 8.0)) table.compute(second, raw_value);
  EXPECT_FALSE(std::isnan(table.low("PSXC_R")));
  EXPECT_FALSE(std::isnan(table.high("PSXC_R", 0)));
  Radome::reset();
  table.compute(8.0, raw_value);
  EXPECT_THAT(table.low("PSXC_R"), IsNan());
  EXPECT_THAT(table.high("PSXC_R", 0), IsNan());
}

TEST(NimbusSystem, ResetBetweenLeaderAndEntryCostsOneSample) {
  ASSERT_TRUE(install_both());
  Table table(raw_names, {{"MACHX", {}, Fuselage::fetch<Quantity::corrected_mach>},
                          {"PCOR", fuselage_inputs, Fuselage::compute},
                          {"PSXC", {"PCOR"}, Fuselage::fetch<Quantity::corrected_static_pressure>}});
  table.compute(0.0, raw_value);
  Fuselage::reset();
  Second = 0.0;
  FeedBack = low_rate_feedback;
  DERTBL& entry = table.entry("PSXC");
  entry.compute(&entry);
  EXPECT_THAT(table.low("PSXC"), IsNan()) << "the leader has not run since";
  table.compute(1.0, raw_value);
  EXPECT_FALSE(std::isnan(table.low("PSXC")));
  EXPECT_THAT(table.low("MACHX"), IsNan()) << "always before the leader";
}

TEST(NimbusSystem, GivesNanWithoutAnInstalledModel) {
  struct Tag;
  using Empty = NimbusSystem<Host, Tag>;
  Table table({"PSFD", "QCF"}, {{"PCOR", {"PSFD", "QCF"}, Empty::compute},
                                {"PSXC", {"PCOR"}, Empty::fetch<Quantity::corrected_static_pressure>},
                                {"PCORFLAG", {"PCOR"}, Empty::fetch_quality}});
  Empty::reset();
  table.compute(0.0, raw_value);
  for (const char* name : {"PCOR", "PSXC", "PCORFLAG"}) {
    EXPECT_THAT(table.low(name), IsNan());
    EXPECT_THAT(table.high(name, 24), IsNan());
  }
}

TEST(NimbusSystem, FormulaVariablesAreSetByName) {
  struct Tag;
  using Thrust = NimbusSystem<Host, Tag>;
  Model model;
  pcor::ModelEffect thrust;
  thrust.id = "my-thrust";
  thrust.formula = "k * TORQUE / 100";
  thrust.parameter_names = {"k"};
  thrust.parameters = {2.0};
  model.effects = {thrust};
  std::string error;
  ASSERT_TRUE(Thrust::install(model, {"static_pressure", "TORQUE", "dynamic_pressure"}, 1, 25, &error))
      << error;
  Table table({"PSFD", "QCF", "ENGTRQ"}, {{"PCOR", {"PSFD", "ENGTRQ", "QCF"}, Thrust::compute}});
  table.compute(0.0, [](const std::string& name, double time) {
    return name == "ENGTRQ" ? static_cast<float>(50.0 + time) : raw_value(name, time);
  });
  EXPECT_EQ(table.low("PCOR"), 1.0F);
  EXPECT_EQ(table.high("PCOR", 24), static_cast<float>(2.0 * static_cast<double>(50.96F) / 100.0));
}

TEST(NimbusSystem, SwappedRatesAreRefused) {
  for (const auto& [low, high] : {std::pair{25.0, 1.0}, {25.0, 25.0}, {1.0, std::nan("")}}) {
    std::string error;
    EXPECT_FALSE(Fuselage::install({}, {"static_pressure", "dynamic_pressure"}, low, high, &error));
    EXPECT_NE(error, "");
  }
}

TEST(NimbusSystem, MisspeltInputIsNamedWithTheNearestRole) {
  std::string error;
  EXPECT_FALSE(Fuselage::install({}, {"static_presure", "dynamic_pressure"}, 1.0, 25.0, &error));
  EXPECT_THAT(
      error, testing::AllOf(testing::HasSubstr("'static_presure'"), testing::HasSubstr("'static_pressure'")));
  Model model;
  model.recovery = {{95.0}};
  EXPECT_FALSE(Fuselage::install(model, {"static_pressure", "dynamic_pressure"}, 1.0, 25.0, &error));
}

TEST(NimbusSystem, FailedInstallationKeepsTheInstalledModel) {
  ASSERT_TRUE(install_both());
  const auto error_of = [](const Model& model, const std::vector<std::string>& inputs,
                           pcor::CorrectWith with = pcor::CorrectWith::model) {
    std::string error = "no error";
    EXPECT_FALSE(Fuselage::install(model, inputs, 1.0, 25.0, &error, with));
    EXPECT_FALSE(Fuselage::install(model, inputs, 1.0, 25.0, nullptr, with));
    return error;
  };
  EXPECT_EQ(error_of({}, {"static_pressure", "dynamic_pressure", "PSFD"}),
            "the input 'PSFD' is neither a role nor a variable of the model's formulas");
  EXPECT_EQ(error_of({}, {"static_pressure", "dynamic_pressure", "corrected_mach"}),
            "the input 'corrected_mach' is derived, not recorded; remove it");
  EXPECT_EQ(error_of({}, {"static_pressure", "dynamic_pressure", "static_pressure"}),
            "two inputs are 'static_pressure'");
  EXPECT_THAT(error_of({}, {"static_pressure"}), testing::HasSubstr("dynamic_pressure"));
  EXPECT_EQ(error_of({}, {"static_pressure", "dynamic_pressure"}, pcor::CorrectWith::lams),
            "correction with LAMS needs the role 'lams_airspeed', which is not among the recorded "
            "quantities; add it, in a "
            "model file as a variable in [variables]");
  Model model;
  pcor::ModelEffect thrust;
  thrust.id = "my-thrust";
  thrust.formula = "TORQUE / 100";
  model.effects = {thrust};
  EXPECT_EQ(error_of(model, {"static_pressure", "dynamic_pressure"}),
            "a formula of the model needs the input 'TORQUE'");

  Table table(raw_names, both_systems());
  table.compute(0.0, raw_value);
  Loop loop = plain(fuselage_model(), fuselage_roles, 1.0);
  run_plain(loop, fuselage_roles, fuselage_inputs, 0.0, raw_value);
  expect_fuselage(loop, [&](const char* name) { return table.low(name); });
}

TEST(NimbusDefaults, ReplaceCoefficientsByName) {
  const Defaults defaults(
      "RECFB 1 0.95\n"
      "PCOR.static-constant.a0 1 0.005\n"
      "PCOR.static-qp.a2 1 -0.25\n"
      "PCOR_R.static-constant.a0 1 0.75\n");
  const auto find = [&defaults](const char* name) { return defaults.value(name); };
  Model fuselage = fuselage_model();
  EXPECT_EQ(pcor::read_defaults(fuselage, "PCOR", find), 2U);
  EXPECT_THAT(fuselage.effects[0].parameters, ElementsAre(static_cast<double>(0.005F)));
  EXPECT_THAT(fuselage.effects[1].parameters, ElementsAre(0.021279816));
  EXPECT_THAT(fuselage.effects[2].parameters, ElementsAre(-0.25));
  Model radome = radome_model();
  EXPECT_EQ(pcor::read_defaults(radome, "PCOR_R", find), 1U);
  EXPECT_THAT(radome.effects[0].parameters, ElementsAre(0.75));
  EXPECT_THAT(radome.effects[1].parameters, ElementsAre(0.15));
}

TEST(NimbusDefaults, UpperCaseNamesAreFound) {
  const Defaults defaults(
      "PCOR.STATIC-CONSTANT.A0 1 0.005\n"
      "PCOR.STATIC-QP.A2 1 -0.25\n"
      "PCOR.STATIC-QP.A9 1 7\n");
  const auto find = [&defaults](const char* name) { return defaults.value(name); };
  Model fuselage = fuselage_model();
  EXPECT_EQ(pcor::read_defaults(fuselage, "PCOR", find), 2U);
  EXPECT_THAT(fuselage.effects[0].parameters, ElementsAre(static_cast<double>(0.005F)));
  EXPECT_THAT(fuselage.effects[2].parameters, ElementsAre(-0.25));
  EXPECT_THAT(pcor::unread_defaults(fuselage, "PCOR", defaults.names()), ElementsAre("PCOR.STATIC-QP.A9"));
}

TEST(NimbusDefaults, EachCoefficientHasOneName) {
  Model model = radome_model();
  pcor::ModelEffect formula;
  formula.id = "my-thrust";
  formula.formula = "k0 + k1 * ENGTRQ";
  formula.parameter_names = {"k0", "k1"};
  formula.parameters = {0.0, 0.0};
  model.effects.push_back(formula);
  EXPECT_THAT(pcor::default_keys(model, "PCOR"), ElementsAre("PCOR.static-constant.a0", "PCOR.static-lag.tau",
                                                             "PCOR.my-thrust.k0", "PCOR.my-thrust.k1"));
}

TEST(NimbusDefaults, UnusedOverridesAreReported) {
  const Defaults defaults(
      "RECFB 1 0.95\n"
      "PCOR.static-constant.a0 1 0.005\n"
      "PCOR.static-constant.a1 1 0.005\n"
      "PCOR.static-mach.m1 1 0.1\n"
      "PCOR_R.static-lag.tau 1 0.2\n");
  EXPECT_THAT(pcor::unread_defaults(fuselage_model(), "PCOR", defaults.names()),
              ElementsAre("PCOR.static-constant.a1", "PCOR.static-mach.m1"));
  EXPECT_THAT(pcor::unread_defaults(radome_model(), "PCOR_R", defaults.names()), IsEmpty());
}

TEST(NimbusDefaults, AreRefusedIfUnused) {
  const auto error_of = [](const std::vector<std::string>& keys, pcor::Overrides expected) {
    std::string error;
    const bool good = pcor::check_defaults(fuselage_model(), "PCOR", keys, expected, &error);
    EXPECT_EQ(good, error.empty());
    EXPECT_EQ(pcor::check_defaults(fuselage_model(), "PCOR", keys, expected, nullptr), good);
    return error;
  };
  const auto some = pcor::Overrides::some;
  EXPECT_EQ(error_of({}, some), "");
  EXPECT_EQ(error_of({"RECFB", "PCOR_R.static-lag.tau", "PCOR.STATIC-QP.A2"}, some), "");
  EXPECT_EQ(
      error_of({"PCOR.STATIC-QP.A9"}, some),
      "the defaults file has 'PCOR.STATIC-QP.A9', which no coefficient of the model reads; the nearest is "
      "'PCOR.static-qp.a2'");
  EXPECT_EQ(
      error_of({"PCOR.STATC-ALPHA.A1"}, some),
      "the defaults file has 'PCOR.STATC-ALPHA.A1', which no coefficient of the model reads; the nearest "
      "is 'PCOR.static-alpha.a1'");
  // `read_defaults` does not request mixed case.
  EXPECT_NE(error_of({"PCOR.Static-Qp.A2"}, some), "");
  EXPECT_NE(error_of({"pcor.static-qp.a2"}, some), "");
  const auto all = pcor::Overrides::all;
  EXPECT_EQ(error_of({"PCOR.STATIC-CONSTANT.A0", "PCOR.static-alpha.a1", "PCOR.STATIC-QP.A2"}, all), "");
  EXPECT_EQ(
      error_of({"PCOR.STATIC-CONSTANT.A0", "PCOR.static-alpha.a1", "PCOR_STATIC-QP.A2"}, all),
      "the defaults file lacks the coefficient 'PCOR.static-qp.a2'; the nearest is 'PCOR_STATIC-QP.A2'");
  EXPECT_EQ(error_of({}, all), "the defaults file lacks the coefficient 'PCOR.static-constant.a0'");
  std::string error;
  EXPECT_FALSE(pcor::check_defaults({}, "PCOR", {"PCOR.STATIC-QP.A2"}, some, &error));
  EXPECT_EQ(error, "the defaults file has 'PCOR.STATIC-QP.A2', which no coefficient of the model reads");
}

}  // namespace
