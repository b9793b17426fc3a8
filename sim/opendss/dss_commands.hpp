// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace gridspace::opendss {

/// Commands of OpenDSS that are read over, in the order in which an abbreviation is looked for: they show, plot or
/// export, or what they do is done anyway. Those with '!' would change the circuit, and are reported as left out.
inline constexpr std::string_view kOtherCommands =
    "calcvoltagebases makebuslist buscoords latlongcoords uuids show plot export visualize help ? "
    "get select say fileedit closedi formedit dump save sample panel totals capacity voltages "
    "currents powers losses summary init quit about comparecases meterzones clone! interpolate "
    "distribute! reduce! estimate! allocateloads! addbusmarker clearbusmarkers relcalc rotate! reset "
    "cktlosses di_plot wait cd! cvrtloadshapes seriescap! fncspublish remove! calcincmatrix buildy "
    "alignfile userclasses propagate! phaselosses nodediff varvalues varnames ysc zsc zsc10 "
    "zscrefresh puvoltages nodelist seqvoltages seqcurrents seqpowers setbusxy guids doscmd!";

} // namespace gridspace::opendss
