// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/impedance_figure.hpp"

#include "agents/relay/functions/distance.hpp"
#include "common/text.hpp"
#include "launcher/judge/signal_rows.hpp"
#include "launcher/report/bay_functions.hpp"
#include "launcher/report/series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::launcher {
namespace {

using relay::Complex;
using relay::PdisParams;

constexpr std::array<char const*, 6> kLoops{"a", "b", "c", "ab", "bc", "ca"};
constexpr double kPlaneHeight = 460, kPlaneWidth = 784; // pixels, so that a circle is one

/// The border of a zone.
std::vector<Complex> border(PdisParams const& p, bool to_earth) {
    double const angle = p.angle_deg * std::numbers::pi / 180;
    Complex const reach = std::polar(p.reach_ohm, angle);
    double const sign = p.forward ? 1 : -1;
    std::vector<Complex> out;
    if (p.characteristic == PdisParams::Characteristic::mho) { // the circle over the reach
        constexpr int kCorners = 120;
        for (int k = 0; k <= kCorners; ++k) {
            out.push_back(sign * 0.5 * (reach + std::polar(p.reach_ohm, 2 * std::numbers::pi * k / kCorners)));
        }
        return out;
    }
    // To the side of the line, below the reach, and forward of the line through the origin that stands upright on it.
    double const r = to_earth ? p.r_earth_ohm : p.r_ohm, x = reach.imag(), along = x / std::tan(angle);
    Complex const foot{r * std::sin(angle) * std::sin(angle), -r * std::sin(angle) * std::cos(angle)};
    for (Complex const corner : {foot, Complex{along + r, x}, Complex{along - r, x}, -foot, foot}) {
        out.push_back(sign * corner);
    }
    return out;
}

struct Box {
    double left{0}, right{0}, low{0}, high{0};
    void include(Complex z) {
        left = std::min(left, z.real());
        right = std::max(right, z.real());
        low = std::min(low, z.imag());
        high = std::max(high, z.imag());
    }
    [[nodiscard]] bool has(double r, double x) const { return r >= left && r <= right && x >= low && x <= high; }
    /// With room around it, and as many ohms to a pixel upwards as sideways.
    [[nodiscard]] Box fitted() const {
        double const scale = 1.3 * std::max((right - left) / kPlaneWidth, (high - low) / kPlaneHeight);
        double const r = (left + right) / 2, x = (low + high) / 2;
        return {r - scale * kPlaneWidth / 2, r + scale * kPlaneWidth / 2, x - scale * kPlaneHeight / 2,
                x + scale * kPlaneHeight / 2};
    }
};

Figure::Series along(std::string name, int colour, std::vector<Complex> const& points) {
    Figure::Series out{std::move(name), {}, {}};
    out.path = true;
    out.colour = colour;
    for (Complex const z : points) {
        out.times_ns.push_back(as_place(z.real()));
        out.values.push_back(z.imag());
    }
    return out;
}

Figure::Series dot(Complex z, int colour, std::string name) {
    Figure::Series out = along("", colour, {z});
    out.points = true;
    out.connected = false;
    out.point_names = {std::move(name)};
    return out;
}

std::string text_of(Complex z) {
    return fmt::format("{:.3g} {} j{:.3g} ohm", z.real(), z.imag() < 0 ? "-" : "+", std::abs(z.imag()));
}

/// When the first of the breakers is no longer closed; seconds.
std::optional<double> first_parts(SignalStore const& signals, std::vector<std::string> const& breakers, double from_s) {
    std::optional<double> out;
    for (std::string const& breaker : breakers) {
        auto const it = signals.find("breaker." + breaker + ".position");
        for (std::size_t i = 0; it != signals.end() && i < it->second.values.size(); ++i) {
            double const t = static_cast<double>(it->second.times_ns[i]) / 1e9;
            if (t >= from_s && it->second.values[i] != kClosedPosition) {
                out = std::min(out.value_or(t), t);
                break;
            }
        }
    }
    return out;
}

/// What a relay saw, on one figure.
class Plane {
  public:
    Plane(Figure& figure, BayFunctions const& relay, SignalStore const& signals)
        : f_{figure}, relay_{relay}, signals_{signals} {}

    /// Nothing is drawn where no loop ever came near a zone.
    bool draw() {
        double const from_s = f_.from_s, to_s = f_.to_s;
        zero_s_ = f_.zero_s;
        zero_name_ = f_.zero_name;
        zones();
        view_ = zone_box_.fitted();
        for (relay::NamedFunction const& f : relay_.functions.functions()) {
            if (f.of == relay::NodeClass::pdis && signals_.contains(signal(f.name, "r_ohm", 0))) {
                loops(f.name, from_s, to_s);
            }
        }
        f_.from_s = view_.left;
        f_.to_s = view_.right;
        f_.y_range = {view_.low, view_.high};
        f_.zero_s = 0;
        f_.zero_name.clear();
        f_.zero_axes = true;
        return !said_.empty();
    }
    [[nodiscard]] std::string const& said() const { return said_; }

  private:
    [[nodiscard]] std::string signal(std::string const& function, char const* part, std::size_t loop) const {
        return fmt::format("relay.{}.{}.{}.{}", relay_.relay, function, part, kLoops[loop]);
    }

    void zones() {
        for (relay::NamedFunction const& f : relay_.functions.functions()) {
            if (f.of != relay::NodeClass::pdis) {
                continue;
            }
            PdisParams const& p = static_cast<relay::Pdis const&>(*f.function).params();
            bool const two = p.characteristic == PdisParams::Characteristic::quadrilateral && p.r_ohm != p.r_earth_ohm;
            for (bool const to_earth : two ? std::vector{false, true} : std::vector{false}) {
                std::vector<Complex> const points = border(p, to_earth);
                std::ranges::for_each(points, [&](Complex z) { zone_box_.include(z); });
                f_.series.push_back(along("", 7, points));
                f_.series.back().dashed = to_earth;
            }
            Complex const reach =
                (p.forward ? 1.0 : -1.0) * std::polar(p.reach_ohm, p.angle_deg * std::numbers::pi / 180);
            f_.series.push_back(along("", 7, {{0, 0}, reach}));
            f_.series.back().dashed = true;
            f_.series.push_back(dot(reach, 7, fmt::format("{}: {} ohm", f.name, shortest(p.reach_ohm))));
        }
    }

    void loops(std::string const& function, double from_s, double to_s) {
        auto const course = course_of(signals_, relay_.relay, function, from_s, to_s);
        auto const parts = first_parts(signals_, relay_.breakers, course ? course->start_s : from_s);
        for (std::size_t loop = 0; loop < kLoops.size(); ++loop) {
            auto const r = signals_.find(signal(function, "r_ohm", loop)),
                       x = signals_.find(signal(function, "x_ohm", loop));
            if (r == signals_.end() || x == signals_.end()) {
                continue;
            }
            std::vector<Complex> path;
            bool near = false;
            Complex last, operated{std::nan(""), 0};
            for (std::size_t i = 0; i < std::min(r->second.values.size(), x->second.values.size()); ++i) {
                double const t = static_cast<double>(r->second.times_ns[i]) / 1e9;
                if (t < from_s || t > to_s || (parts && t >= *parts)) {
                    continue;
                }
                Complex const z{r->second.values[i], x->second.values[i]};
                bool const there = std::isfinite(z.real()) && std::isfinite(z.imag());
                path.push_back(there ? z : Complex{0, std::nan("")}); // the pen is up
                near = near || (there && view_.has(z.real(), z.imag()));
                last = there ? z : last;
                operated = there && course && course->operate_s && t <= *course->operate_s ? z : operated;
            }
            if (!near) {
                continue;
            }
            int const colour = static_cast<int>(loop);
            f_.series.push_back(along(fmt::format("loop {}", kLoops[loop]), colour, path));
            f_.series.push_back(dot(last, colour, ""));
            said_ += fmt::format(" Loop {} ends at {}{}.", kLoops[loop], text_of(last),
                                 parts ? " when the breaker parts" : "");
            if (std::isfinite(operated.real()) && view_.has(operated.real(), operated.imag())) {
                double const at_s = *course->operate_s;
                f_.series.push_back(dot(operated, colour,
                                        zero_name_.empty() ? fmt::format("{} operates at {:.4f} s", function, at_s)
                                                           : fmt::format("{} operates {:.3g} ms after {}", function,
                                                                         (at_s - zero_s_) * 1e3, zero_name_)));
            }
        }
    }

    Figure& f_;
    BayFunctions const& relay_;
    SignalStore const& signals_;
    Box zone_box_, view_;
    double zero_s_{0};
    std::string zero_name_;
    std::string said_;
};

} // namespace

void impedance_planes(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out) {
    for (BayFunctions const& relay : bay_functions(run.scenario, settings.streams.name)) {
        Figure f = empty_plane(settings, run, relay.relay, "resistance, ohm (primary)", "reactance, ohm (primary)");
        f.plot_height = kPlaneHeight;
        Plane plane{f, relay, run.results.signals};
        if (!plane.draw()) {
            continue;
        }
        f.note += f.note.empty() ? "" : " ";
        f.note +=
            "Impedances of the loops that count, seen from the relay's transformers; a path comes from the load, often "
            "from outside of the picture, and ends at its dot." +
            plane.said() +
            " A mho is drawn as the circle over its reach; polarised by the voltage before the fault, it reaches "
            "further back towards the source.";
        out.push_back(std::move(f));
    }
}

} // namespace gridspace::launcher
