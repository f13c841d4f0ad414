// Host with callbacks: record of a sample, defaults, and table of derived variables. The host computes the
// variables at two rates, in the order of their dependencies.
#include "host.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "pcor_callbacks.hpp"

FeedBackType FeedBack = LOW_RATE_FEEDBACK;

namespace {

const std::map<std::string, float> defaults{{"RECFB", 0.95F}, {"PCOR.STATIC-CONSTANT.A0", -4.4e-3F}};

std::map<std::string, std::size_t> places;
std::vector<float> record;

std::size_t place_of(const std::string& name) {
  const auto found = places.emplace(name, places.size()).first;
  record.resize(places.size());
  return found->second;
}

// Every result depends on PCOR. Without this dependency a host may omit a result or compute it one sample
// late.
std::vector<DERTBL> deriveftns{
    {"TASX", {"PCOR"}, stasx},
    {"PSXC", {"PCOR"}, spsxc},
    {"QCXC", {"PCOR"}, sqcxc},
    {"MACHX", {"PCOR"}, smachx},
    {"ATX", {"PCOR"}, satx},
    {"PCORFLAG", {"PCOR"}, spcorflag},
    {"PCOR", {"PSFD", "QCF", "RTF1", "EWX", "ATTACK"}, spcor},
};

void append(std::vector<DERTBL*>& order, DERTBL& entry) {
  if (std::find(order.begin(), order.end(), &entry) != order.end()) return;
  for (DERTBL& other : deriveftns) {
    if (std::count(entry.depends.begin(), entry.depends.end(), other.name) > 0) append(order, other);
  }
  order.push_back(&entry);
}

std::vector<DERTBL*> compute_order() {
  std::vector<DERTBL*> order;
  for (DERTBL& entry : deriveftns) {
    entry.place = place_of(entry.name);
    for (const std::string& name : entry.depends) entry.depend_places.push_back(place_of(name));
    append(order, entry);
  }
  return order;
}

}  // namespace

float GetSample(const DERTBL* entry, std::size_t input) { return record[entry->depend_places[input]]; }
void PutSample(const DERTBL* entry, float value) { record[entry->place] = value; }

const float* GetDefault(const char* name) {
  const auto found = defaults.find(name);
  return found == defaults.end() ? nullptr : &found->second;
}

std::vector<std::string> DefaultNames() {
  std::vector<std::string> names;
  for (const auto& each : defaults) names.push_back(each.first);
  return names;
}

int main() {
  std::string error;
  if (!pcor_install(&error)) return std::fprintf(stderr, "%s\n", error.c_str()), 1;
  const std::vector<DERTBL*> order = compute_order();
  for (int second = 0; second < 3; ++second) {
    for (const FeedBackType rate : {LOW_RATE_FEEDBACK, HIGH_RATE_FEEDBACK}) {
      FeedBack = rate;
      const int samples = rate == LOW_RATE_FEEDBACK ? 1 : 25;
      for (int sample = 0; sample < samples; ++sample) {
        const float time = static_cast<float>(second) + static_cast<float>(sample) / 25.0F;
        record[place_of("PSFD")] = 700.0F - 0.6F * time;  // hPa
        record[place_of("QCF")] = 67.6F;                  // hPa
        record[place_of("RTF1")] = 6.9F;                  // deg C
        record[place_of("EWX")] = 4.2F;                   // hPa
        record[place_of("ATTACK")] = 3.1F;                // deg
        for (DERTBL* entry : order) entry->compute(entry);
      }
    }
    std::printf("%d s:", second);
    for (const DERTBL& entry : deriveftns) {
      const float value = record[entry.place];
      if (std::isnan(value)) return std::fprintf(stderr, " %s is missing\n", entry.name.c_str()), 1;
      std::printf(" %s %.4f", entry.name.c_str(), static_cast<double>(value));
    }
    std::printf("\n");
  }
}
