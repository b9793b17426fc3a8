// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace gridspace::ids {

using DoublePair = double __attribute__((vector_size(16))); ///< in one register on x86-64 and ARM64
using IntegerPair = std::int64_t __attribute__((vector_size(16)));

/// `n` pairs side by side. The steps of one number wait for each other; those of others fill the gaps. What a number
/// becomes does not depend on its neighbours.
template <std::size_t n>
struct DoublePairs {
    DoublePair pair[n];

    template <class Operation>
    static DoublePairs each(Operation operation) {
        DoublePairs out;
        for (std::size_t i = 0; i < n; ++i) {
            out.pair[i] = operation(i);
        }
        return out;
    }
    static DoublePairs from(double const* values) {
        return each([&](std::size_t i) {
            DoublePair out;
            std::memcpy(&out, values + 2 * i, sizeof out);
            return out;
        });
    }
    void to(double* values) const {
        for (std::size_t i = 0; i < n; ++i) {
            std::memcpy(values + 2 * i, &pair[i], sizeof pair[i]);
        }
    }
    friend DoublePairs operator+(DoublePairs const& a, DoublePairs const& b) {
        return each([&](std::size_t i) { return a.pair[i] + b.pair[i]; });
    }
    friend DoublePairs operator-(DoublePairs const& a, DoublePairs const& b) {
        return each([&](std::size_t i) { return a.pair[i] - b.pair[i]; });
    }
    friend DoublePairs operator*(DoublePairs const& a, DoublePairs const& b) {
        return each([&](std::size_t i) { return a.pair[i] * b.pair[i]; });
    }
    friend DoublePairs operator/(DoublePairs const& a, DoublePairs const& b) {
        return each([&](std::size_t i) { return a.pair[i] / b.pair[i]; });
    }
    friend DoublePairs operator+(DoublePairs const& a, double b) {
        return each([&](std::size_t i) { return a.pair[i] + b; });
    }
    friend DoublePairs operator-(DoublePairs const& a, double b) {
        return each([&](std::size_t i) { return a.pair[i] - b; });
    }
    friend DoublePairs operator*(DoublePairs const& a, double b) {
        return each([&](std::size_t i) { return a.pair[i] * b; });
    }
};

} // namespace gridspace::ids
