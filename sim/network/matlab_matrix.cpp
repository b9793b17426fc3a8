// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/matlab_matrix.hpp"

#include <cmath>

namespace gridspace::sim {

std::map<std::string, double> const& matpower_columns() {
    static std::map<std::string, double> const names{
        {"PQ", 1},     {"PV", 2},       {"REF", 3},    {"NONE", 4},       {"BUS_I", 1},    {"BUS_TYPE", 2},
        {"PD", 3},     {"QD", 4},       {"GS", 5},     {"BS", 6},         {"BUS_AREA", 7}, {"VM", 8},
        {"VA", 9},     {"BASE_KV", 10}, {"ZONE", 11},  {"VMAX", 12},      {"VMIN", 13},    {"F_BUS", 1},
        {"T_BUS", 2},  {"BR_R", 3},     {"BR_X", 4},   {"BR_B", 5},       {"RATE_A", 6},   {"RATE_B", 7},
        {"RATE_C", 8}, {"TAP", 9},      {"SHIFT", 10}, {"BR_STATUS", 11}, {"GEN_BUS", 1},  {"PG", 2},
        {"QG", 3},     {"QMAX", 4},     {"QMIN", 5},   {"VG", 6},         {"MBASE", 7},    {"GEN_STATUS", 8},
        {"PMAX", 9},   {"PMIN", 10},
    };
    return names;
}

double (*matlab_function(std::string const& word))(double) {
    if (word == "sin")
        return [](double v) { return std::sin(v); };
    if (word == "cos")
        return [](double v) { return std::cos(v); };
    if (word == "tan")
        return [](double v) { return std::tan(v); };
    if (word == "acos")
        return [](double v) { return std::acos(v); };
    if (word == "sqrt")
        return [](double v) { return std::sqrt(v); };
    return nullptr;
}

} // namespace gridspace::sim
