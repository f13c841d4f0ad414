#pragma once

#include <string>

#include "host.hpp"

/// Prepares the correction. Call it before the first sample and before the host orders its table. Returns
/// false on failure; `error` states the reason.
bool pcor_install(std::string* error);

/// Discards earlier samples. Call it at the start of a flight and after a gap.
void pcor_reset();

// Names for the table of derived variables: plain C functions, because the table has no templates.
extern "C" {
void spcor(DERTBL* entry);
void spsxc(DERTBL* entry);
void sqcxc(DERTBL* entry);
void smachx(DERTBL* entry);
void satx(DERTBL* entry);
void stasx(DERTBL* entry);
void spcorflag(DERTBL* entry);
}
