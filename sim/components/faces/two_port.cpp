// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/faces/two_port.hpp"

namespace gridspace::sim {

Admittances seen_from(Admittances y, Ends closed) {
    if (closed.from && closed.to) {
        return y;
    }
    Complex const through = y.ft * y.tf;
    Admittances seen;
    if (closed.from && y.tt != Complex{}) {
        seen.ff = y.ff - through / y.tt;
    }
    if (closed.to && y.ff != Complex{}) {
        seen.tt = y.tt - through / y.ff;
    }
    return seen;
}

} // namespace gridspace::sim
