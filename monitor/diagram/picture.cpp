// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/diagram/picture.hpp"

#include "common/text.hpp"
#include "monitor/diagram/layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::diagram {
namespace {

/// The colours are those of the page around it, where it has some.
constexpr std::string_view kStyle =
    ".oneline{--dg-ink:var(--ink,var(--fg,currentColor));--dg-soft:var(--soft,var(--dim,#5d6673));"
    "--dg-bad:var(--bad,#b3261e);--dg-back:var(--panel,var(--card,#fff))}"
    ".oneline path,.oneline circle,.oneline rect{fill:none;stroke:var(--dg-ink);stroke-width:1.4}"
    ".oneline text{font:12px system-ui,-apple-system,'Segoe UI',sans-serif;fill:var(--dg-ink);stroke:none}"
    ".oneline .small{font-size:11px;fill:var(--dg-soft)}.oneline .tiny{font-size:10px}"
    ".oneline .middle{text-anchor:middle}.oneline .end{text-anchor:end}.oneline .bus .bar{stroke-width:5}"
    ".oneline .back{fill:var(--dg-back)}.oneline .arrowhead{fill:var(--dg-ink)}.oneline "
    ".charge{fill:#0b7a4b;stroke:none}"
    ".oneline .branch.open>.wire{stroke-dasharray:4 4;stroke:var(--dg-soft)}"
    ".oneline .breaker .box{fill:var(--dg-ink)}.oneline .breaker.opened .box{fill:var(--dg-back);stroke:var(--dg-bad)}"
    ".oneline .breaker.between .box{fill:var(--dg-back);stroke:#8a5a00}"
    ".oneline .breaker.opened text{fill:var(--dg-bad);font-weight:600}"
    ".oneline .relay path{stroke-dasharray:2 2;stroke:var(--dg-soft)}.oneline .relay rect{stroke:var(--dg-soft)}"
    ".oneline .fault .bolt{fill:var(--dg-bad);stroke:var(--dg-back);stroke-width:1}.oneline .fault "
    "text{fill:var(--dg-bad)}"
    ".oneline .later{visibility:hidden}";

/// What stands in the circle of a machine or a converter; a wind turbine has blades.
std::string_view sign_of(std::string_view kind) {
    return kind == "pv" ? "☀" : kind == "induction_machine" ? "M" : "~";
}

enum class Anchor { start, middle, end };

class Painter {
  public:
    Painter(Grid const& grid, Look const& look) : grid_{grid}, look_{look}, layout_{lay_out(grid, look.live)} {}

    Picture paint() {
        for (Route const& route : layout_.routes) {
            branch(route);
        }
        for (Bar const& bar : layout_.bars) {
            bus(bar);
        }
        for (Hanging const& device : layout_.devices) {
            hanging(device);
        }
        faults();
        out_.svg =
            fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"oneline\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
                        "role=\"group\" aria-label=\"one-line diagram\" "
                        "style=\"min-width:{2:.0f}px;max-width:{3:.0f}px\"><style>{4}</style>\n{5}</svg>\n",
                        layout_.width, layout_.height, 0.66 * layout_.width, 1.25 * layout_.width, kStyle, svg_);
        return std::move(out_);
    }

  private:
    /// `classes`: small, tiny; `room`: for a live value behind it, or (`below`) in a row below it.
    void text(Point at, std::string const& content, Anchor anchor, char const* classes, double room = 0,
              bool below = false) {
        room = look_.live ? room : 0;
        double const own = width_of(content), width = below ? std::max(own, room) : own + room;
        double const left = at.x - (anchor == Anchor::start ? 0 : anchor == Anchor::middle ? width / 2 : width);
        out_.labels.push_back({content, left, at.y - 10, left + width, at.y + (below && room > 0 ? kValueRow : 0) + 3});
        svg_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"{}{}\">{}", at.x, at.y, classes,
                            anchor == Anchor::start    ? ""
                            : anchor == Anchor::middle ? " middle"
                                                       : " end",
                            escape_markup(content));
        if (room > 0) {
            svg_ += below ? fmt::format(" <tspan class=\"value\" x=\"{:.1f}\" dy=\"{}\"></tspan>", at.x, kValueRow)
                          : " <tspan class=\"value\"></tspan>";
        }
        svg_ += "</text>";
    }
    std::optional<double> last(std::string const& signal) const {
        return look_.last ? look_.last(signal) : std::nullopt;
    }
    void begin(std::string_view classes, std::string const& name, std::string const& title) {
        svg_ += fmt::format("<g class=\"{}\" data-name=\"{}\"><title>{}</title>", classes, escape_markup(name),
                            escape_markup(title));
    }
    void end() { svg_ += "</g>\n"; }

    void branch(Route const& route) {
        Grid::Branch const& b = *route.branch;
        bool const open = std::any_of(route.symbols.begin(), route.symbols.end(),
                                      [&](Symbol const& s) { return !s.is_ct && position_of(s.name) == 1; });
        begin(open ? "branch open" : "branch", b.name, b.kind + " " + b.label);
        std::string path;
        for (Point const& p : route.path) {
            path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", p.x, p.y);
        }
        svg_ += fmt::format("<path class=\"wire\" d=\"{}\"/>", path);
        bool const transformer = b.kind == "transformer";
        if (transformer) {
            double const dx = route.upright ? 0 : 6, dy = route.upright ? 6 : 0;
            for (double const sign : {-1.0, 1.0}) {
                svg_ += fmt::format("<circle class=\"back\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"9\"/>",
                                    route.label.x + sign * dx, route.label.y + sign * dy);
            }
            svg_ +=
                fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"9\"/>", route.label.x - dx, route.label.y - dy);
        }
        if (route.upright) {
            text({route.label.x + (transformer ? 16 : 8), route.label.y + 4}, b.label, Anchor::start, "small",
                 kValueRoom);
        } else {
            double const up = (transformer ? 12 : 7) + (look_.live ? kValueRow : 0);
            text({route.label.x, route.label.y - up}, b.label, Anchor::middle, "small", kValueRoom, true);
        }
        for (Symbol const& s : route.symbols) {
            symbol(s, route.upright);
        }
        end();
    }

    int position_of(std::string const& name) const {
        auto const position = last("breaker." + name + ".position");
        return static_cast<int>(std::lround(position ? *position : last("fuse." + name + ".position").value_or(2)));
    }

    void symbol(Symbol const& s, bool upright) {
        Point const at = s.at, name{upright ? at.x + 11 : at.x, upright ? at.y + 4 : at.y - 9};
        Anchor const anchor = upright ? Anchor::start : Anchor::middle;
        if (s.is_ct) {
            begin("ct", s.name, "current transformer " + s.name);
            svg_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"6\"/>", at.x, at.y);
            text(name, s.name, anchor, "small");
            end();
        } else {
            static constexpr std::array<char const*, 4> kStates{"intermediate", "open", "closed", "bad"};
            int const position = position_of(s.name);
            begin(position == 1   ? "breaker opened"
                  : position == 2 ? "breaker closed"
                                  : "breaker between",
                  s.name,
                  fmt::format("{}: {}", s.name,
                              look_.live ? "not told" : kStates[static_cast<std::size_t>(std::clamp(position, 0, 3))]));
            svg_ += fmt::format("<rect class=\"box\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"11\" height=\"11\"/>",
                                at.x - 5.5, at.y - 5.5);
            text(name, s.name, anchor, "small");
            end();
        }
        for (std::size_t t = 0; t < s.tags.size(); ++t) {
            relay(s, t, upright);
        }
    }

    void relay(Symbol const& s, std::size_t number, bool upright) {
        double const wide = width_of(s.tags[number]) + 8, x = s.tags_x[number];
        double const y = upright ? s.at.y : s.at.y + 23 + kTagRow * static_cast<double>(number); // middle of the tag
        begin("relay", s.tags[number].substr(0, s.tags[number].find(' ')),
              fmt::format("relay {} looks at {}", s.tags[number], s.name));
        svg_ += upright ? fmt::format("<path d=\"M{:.1f} {:.1f}H{:.1f}\"/>", x - wide / 2 - 8, y, x - wide / 2)
                        : fmt::format("<path d=\"M{:.1f} {:.1f}V{:.1f}\"/>", s.at.x, s.at.y + 6, y - 8);
        svg_ += fmt::format("<rect class=\"back\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"15\" rx=\"3\"/>",
                            x - wide / 2, y - 8, wide);
        text({x, y + 3.5}, s.tags[number], Anchor::middle, "small");
        end();
    }

    void bus(Bar const& bar) {
        Grid::Bus const& b = *bar.bus;
        begin("bus", b.name, fmt::format("bus {}, {} V", b.label, shortest(b.voltage_v)));
        svg_ += fmt::format("<path class=\"bar\" d=\"M{0:.1f} {1:.1f}V{2:.1f}\"/>", bar.x, bar.top, bar.bottom);
        text({bar.tied ? bar.x + 7 : bar.x, bar.top - 8}, b.label, bar.tied ? Anchor::start : Anchor::middle, "",
             kValueRoom);
        end();
    }

    void hanging(Hanging const& h) {
        Grid::Device const& d = *h.device;
        double const y = h.at.y, x = h.at.x + (h.left ? -22 : kStub);
        begin("device " + d.kind, d.name, d.kind + " " + d.label);
        svg_ += fmt::format("<path d=\"M{:.1f} {:.1f}H{:.1f}\"/>", h.at.x, y, x);
        DeviceShape const shape = shape_of(d.kind);
        switch (shape) {
        case DeviceShape::source: {
            double const left = h.left ? x - 22 : x;
            svg_ += fmt::format("<rect x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"22\" height=\"18\"/>", left, y - 9);
            text({left + 11, y + 3.5}, "grid", Anchor::middle, "tiny");
            break;
        }
        case DeviceShape::circle:
            svg_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"8\"/>", x + 8, y);
            svg_ +=
                d.kind == "wind_turbine"
                    ? fmt::format("<path d=\"M{0:.1f} {1:.1f}v-6.5m0 6.5l5.6 3.25m-5.6 -3.25l-5.6 3.25\"/>", x + 8, y)
                    : fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"tiny middle\">{}</text>", x + 8, y + 3.5,
                                  sign_of(d.kind));
            break;
        case DeviceShape::store: {
            double const charge = last(d.kind + "." + d.name + ".soc_percent").value_or(0);
            svg_ +=
                fmt::format("<rect class=\"cell\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"30\" height=\"12\" rx=\"2\"/>"
                            "<rect class=\"charge\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"9\" rx=\"1\"/>",
                            x, y - 6, x + 1.5, y - 4.5, 0.27 * std::clamp(charge, 0.0, 100.0));
            break;
        }
        case DeviceShape::arrow:
            svg_ += fmt::format("<path class=\"arrowhead\" d=\"M{0:.1f} {1:.1f}l9 4.5l-9 4.5z\"/>", x, y - 4.5);
        }
        double const label = x + label_offset(shape);
        bool const same = std::any_of(grid_.buses.begin(), grid_.buses.end(), [&](Grid::Bus const& b) {
            return d.kind == "source" && b.name == d.bus && b.label == d.label;
        });
        if (!h.left) {
            text({label, y + 4}, d.label, Anchor::start, "small", room_of(shape));
        } else if (!same) { // the bus says it already
            text({x - 11, y + 22}, d.label, Anchor::middle, "small");
        }
        end();
    }

    void faults() {
        std::map<std::string, double> before; // on the same branch or bus
        for (Grid::Fault const& f : grid_.faults) {
            std::string const at = f.line.empty() ? fmt::format("bus {}", f.bus)
                                                  : fmt::format("{}, {} %", f.line, shortest(f.position_percent));
            double const down = 10 + kFaultRow * before[at.substr(0, at.find(','))]++;
            Point bolt, label;
            Anchor anchor = Anchor::start;
            if (f.line.empty()) {
                auto const bar = std::find_if(layout_.bars.begin(), layout_.bars.end(),
                                              [&](Bar const& b) { return b.bus->name == f.bus; });
                if (bar == layout_.bars.end()) {
                    continue;
                }
                bolt = {bar->x - 6, bar->bottom};
                label = {bar->x - 18, bar->bottom + 10 + down};
                anchor = Anchor::end;
            } else {
                auto const route = std::find_if(layout_.routes.begin(), layout_.routes.end(),
                                                [&](Route const& r) { return r.branch->name == f.line; });
                if (route == layout_.routes.end()) {
                    continue;
                }
                bolt = route->at(f.position_percent / 100);
                bool const leftwards = route->upright || 2 * bolt.x > route->bare[0].x + route->bare[1].x;
                label = {bolt.x + (leftwards ? -12 : 12), bolt.y + 10 + down};
                anchor = leftwards ? Anchor::end : Anchor::start;
            }
            begin(look_.live ? "fault later" : "fault", f.name,
                  fmt::format("{} at {}, {} s", f.name, at, shortest(f.at_s)));
            svg_ += fmt::format("<path class=\"bolt\" d=\"M{:.1f} {:.1f}l-8 14h6l-6 14l14 -18h-7l6 -10z\"/>", bolt.x,
                                bolt.y + 2);
            text(label, f.name, anchor, "small");
            end();
        }
    }

    Grid const& grid_;
    Look const& look_;
    Layout layout_;
    std::string svg_;
    Picture out_;
};

} // namespace

Picture one_line(Grid const& grid, Look const& look) {
    return Painter{grid, look}.paint();
}

} // namespace gridspace::diagram
