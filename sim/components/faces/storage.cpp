// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/faces/storage.hpp"

#include <fmt/format.h>

namespace gridspace::sim {

void check_powers(config::Fields& f, std::string const& name, double p_kw, double q_kvar, double rating_kva) {
    if (rating_kva > 0 && std::hypot(p_kw, q_kvar) > rating_kva * (1 + 1e-9)) {
        f.error("rating_kva", fmt::format("p_kw and q_kvar of '{}' are {:.4g} kVA, more than its rating", name,
                                          std::hypot(p_kw, q_kvar)));
    }
}

} // namespace gridspace::sim
