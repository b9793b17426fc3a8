// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/random.hpp"

#include "common/elementary.hpp"

#include <bit>
#include <cmath>

namespace gridspace {
namespace {

/// SplitMix64: spreads a seed over the state (Steele, Lea, Flood 2014).
std::uint64_t spread(std::uint64_t& x) {
    x += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = x;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
}

std::uint64_t number_of(std::string_view name) { // FNV-1a
    std::uint64_t h = 0xCBF29CE484222325ULL;
    for (char const c : name) {
        h = (h ^ static_cast<unsigned char>(c)) * 0x100000001B3ULL;
    }
    return h;
}

} // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream) {
    std::uint64_t x = seed;
    x = spread(x) ^ stream;
    for (std::uint64_t& word : state_) {
        word = spread(x);
    }
}

Random::Random(std::uint64_t seed, std::string_view stream_name) : Random{seed, number_of(stream_name)} {}

std::uint64_t Random::next() { // xoshiro256** (Blackman, Vigna 2018)
    std::uint64_t const out = std::rotl(state_[1] * 5, 7) * 9, t = state_[1] << 17U;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = std::rotl(state_[3], 45);
    return out;
}

double Random::uniform() {
    return static_cast<double>(next() >> 11U) * 0x1p-53;
}

double Random::uniform(double low, double high) {
    return low + (high - low) * uniform();
}

double Random::normal() { // Box and Muller
    if (has_spare_) {
        has_spare_ = false;
        return spare_;
    }
    double const radius = std::sqrt(-2 * elementary::log(1 - uniform()));
    double const angle = 6.283185307179586 * uniform();
    spare_ = radius * elementary::sin(angle);
    has_spare_ = true;
    return radius * elementary::cos(angle);
}

std::uint64_t Random::below(std::uint64_t n) {
    std::uint64_t const reject = (0 - n) % n; // 2^64 mod n
    for (;;) {
        std::uint64_t const x = next();
        if (x >= reject) {
            return x % n;
        }
    }
}

} // namespace gridspace
