// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/line_constants/mode_fit.hpp"

#include "sim/line_constants/vector_fit.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim {
namespace {

using Complex = std::complex<double>;

constexpr double kLowestHz = 1e-3, kSamplesPerDecade = 10;
constexpr int kSamples = 86; ///< up to 316 kHz
/// Beyond it errors count less and less: no step of use shows it.
constexpr double kWellFittedHz = 3e4;
/// Stands for direct current.
constexpr double kDirectOmega = 1e-6;
constexpr int kPoles = 16, kRoundsToSearch = 6, kRounds = 12;
constexpr double kLargestFitError = 0.01;
/// Waves that travel for longer are no line's, and would need room for all that is on its way.
constexpr double kLongestTravelS = 1;
/// Delays that are tried between the least and the largest that it can be.
constexpr int kDelays = 13;
/// Of the propagation, where its delay is largest.
constexpr double kFadedOut = 0.1;

/// The last two are those that are met exactly.
std::vector<double> frequencies(double nominal_omega) {
    std::vector<double> out;
    for (int k = 0; k < kSamples; ++k) {
        out.push_back(2 * std::numbers::pi * kLowestHz * std::pow(10.0, k / kSamplesPerDecade));
    }
    out.push_back(nominal_omega);
    out.push_back(kDirectOmega);
    return out;
}

/// The travel time is the delay without which the rest is of minimum phase: of a few between what the highest
/// frequencies tend to, and what they have where they have faded out, the one whose fit is best.
double least_delay(ModePerMetre const& mode, double length_m, double highest) {
    auto const delay = [&](double omega) { return mode.per_m(omega).imag() * length_m / omega; };
    // Skin effect falls with the root of the frequency.
    return 2 * delay(highest) - delay(highest / 4);
}

double largest_delay(std::vector<Complex> const& gamma, std::vector<double> const& omega) {
    double out = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(kSamples); ++i) {
        out = gamma[i].imag() / omega[i];
        if (std::exp(-gamma[i].real()) < kFadedOut) {
            break;
        }
    }
    return out;
}

} // namespace

Result<emt::MartiLine::Mode> fit_mode(ModePerMetre const& mode, double length_m, double nominal_omega) {
    std::vector<double> const omega = frequencies(nominal_omega);
    constexpr std::size_t kExact = kSamples;
    FrequencyResponse surge{omega, {}, {}}, travel{omega, std::vector<Complex>(omega.size()), {}};
    std::vector<Complex> gamma; // of the whole length
    for (double const w : omega) {
        gamma.push_back(mode.per_m(w) * length_m);
        double const band = 1 / (1 + w / (2 * std::numbers::pi * kWellFittedHz));
        surge.value.push_back(mode.surge_ohm(w));
        surge.weight.push_back(band / std::abs(surge.value.back()));
        // Of a short line at low frequencies it is the difference from one that counts.
        travel.weight.push_back(band / std::min(1.0, std::abs(gamma.back())));
    }
    auto const without = [&](double tau) {
        for (std::size_t i = 0; i < omega.size(); ++i) {
            travel.value[i] = std::exp(Complex{0, omega[i] * tau} - gamma[i]);
        }
    };
    emt::MartiLine::Mode out;
    double const least = least_delay(mode, length_m, omega[kExact - 1]), largest = largest_delay(gamma, omega);
    if (!(least > 0 && least <= 1.001 * largest && largest < kLongestTravelS)) {
        return fail(ExitCode::usage,
                    fmt::format("its travel time would be between {:.3g} and {:.3g} s", least, largest),
                    "look at its length and its data");
    }
    double best = 0;
    for (int k = 0; k < kDelays; ++k) {
        double const tau = least + (largest - least) * k / (kDelays - 1);
        without(tau);
        double const error = fit_error(travel, kExact, vector_fit(travel, kExact, kPoles, kRoundsToSearch));
        if (k == 0 || error < best) {
            best = error;
            out.tau_s = tau;
        }
    }
    without(out.tau_s);
    out.propagation = vector_fit(travel, kExact, kPoles, kRounds);
    out.impedance = vector_fit(surge, kExact, kPoles, kRounds);
    double const errors[] = {fit_error(travel, kExact, out.propagation), fit_error(surge, kExact, out.impedance)};
    if (!(errors[0] < kLargestFitError && errors[1] < kLargestFitError)) {
        return fail(
            ExitCode::usage,
            fmt::format("no rational function is near its propagation and impedance: errors of {:.2g} and {:.2g}",
                        errors[0], errors[1]),
            "look at its data, or use `model: bergeron`");
    }
    return out;
}

} // namespace gridspace::sim
