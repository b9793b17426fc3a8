// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/diagram/layout.hpp"

#include "monitor/diagram/symbols.hpp"
#include "monitor/diagram/ways.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace gridspace::diagram {
namespace {

constexpr double kMargin = 10, kAbove = 20, kBelow = 12, kUprightRow = 19, kTrack = 12, kLane = 18, kLabelRoom = 30,
                 kBetweenRows = 16;

/// A branch while its place is looked for.
struct Run : Way {
    explicit Run(Way const& way) : Way{way} {
        route.branch = branch;
        route.upright = kind == Kind::upright;
    }
    Route route;
    std::array<double, 2> reach{};  ///< of the symbols at the left and the right bus
    std::array<double, 2> tracks{}; ///< where it turns: behind the left bus, before the right one
};

class Layouter {
  public:
    Layouter(Grid const& grid, bool live)
        : grid_{grid}, value_{live ? kValueRoom : 0}, above_{live ? kAbove + kValueRow : kAbove},
          first_tap_{above_ + 2}, cells_{places(grid)} {
        for (std::size_t b = 0; b < grid.buses.size(); ++b) {
            number_.emplace(grid.buses[b].name, b);
            columns_ = std::max(columns_, cells_[b].column + 1);
            rows_ = std::max(rows_, cells_[b].row + 1);
        }
    }

    Layout lay_out() {
        Ways ways = find_ways(grid_, cells_, number_);
        lanes_ = std::move(ways.lanes);
        for (Way const& way : ways.all) {
            runs_.emplace_back(way);
        }
        for (Ways::Slots& slots : ways.slots) {
            static_cast<Ways::Slots&>(taps_.emplace_back()) = std::move(slots);
        }
        find_devices();
        find_heights();
        find_widths();
        draw_routes();
        for (std::size_t b = 0; b < grid_.buses.size(); ++b) {
            out_.bars.push_back({&grid_.buses[b], x_[cells_[b].column], top(b), top(b) + taps_[b].bottom, is_tied(b)});
        }
        for (Hanging& h : out_.devices) {
            h.at.x = x_[cells_[number_.at(h.device->bus)].column];
        }
        return std::move(out_);
    }

  private:
    /// What stands at a bar, by its height below the bar's top.
    struct Taps : Ways::Slots {
        std::vector<Grid::Device const*> devices;
        Grid::Device const* source{nullptr}; ///< at the left
        double bottom{30}, block{30};        ///< of the bar; of all that belongs to it
    };
    struct Gap {
        double symbols{0}, label{0}, tracks{0}, before{0}; ///< behind a bar, in the middle, for turns, before the next
        double beside{0};                                  ///< symbols and label together at least
        double name_behind{0}, name_before{0};             ///< of buses, which stand above all that
    };

    using Turns = std::vector<std::pair<Run*, std::size_t>>; ///< of branches, and which of their tracks

    void find_devices() {
        for (Grid::Device const& device : grid_.devices) {
            if (auto const bus = number_.find(device.bus); bus != number_.end()) {
                Taps& taps = taps_[bus->second];
                bool const left = device.kind == "source" && taps.left.empty() && taps.source == nullptr;
                (left ? taps.source = &device : taps.devices.emplace_back(&device));
            }
        }
    }

    double top(std::size_t bus) const { return tops_[cells_[bus].row]; }
    double tap(std::size_t bus, std::size_t slot) const {
        return top(bus) + first_tap_ + pitch_ * static_cast<double>(slot);
    }

    void find_heights() {
        find_pitch();
        std::vector<double> heights(rows_, 30), needs(rows_, 0);
        for (std::size_t b = 0; b < grid_.buses.size(); ++b) {
            find_bar(b);
            heights[cells_[b].row] = std::max(heights[cells_[b].row], taps_[b].block);
        }
        for (Run& run : runs_) {
            find_symbols(run);
            if (run.kind == Way::Kind::upright) {
                double const own = (run.route.branch->kind == "transformer" ? 44 : 24) +
                                   kUprightRow * static_cast<double>(run.route.symbols.size() + 1);
                std::size_t const row = cells_[run.left].row;
                needs[row] = std::max(needs[row], own - (heights[row] - taps_[run.left].block));
            }
        }
        place_rows(heights, needs);
        for (Hanging& h : out_.devices) {
            h.at.y += top(number_.at(h.device->bus));
        }
        for (std::size_t b = 0; b < grid_.buses.size(); ++b) {
            if (taps_[b].source != nullptr) {
                out_.devices.push_back({taps_[b].source, {0, tap(b, 0)}, true});
            }
        }
    }

    /// From a branch to the next one below it.
    void find_pitch() {
        std::map<std::string, double> faults, tags;
        for (Grid::Fault const& fault : grid_.faults) {
            below_ = std::max(below_, fault.line.empty() ? 0 : 30 + kFaultRow * faults[fault.line]++);
        }
        for (Grid::Relay const& relay : grid_.relays) {
            for (config::Ref const& ct : relay.cts) {
                below_ = std::max(below_, 34 + kTagRow * tags[ct.name]++);
            }
        }
        pitch_ = above_ + below_ + 2;
    }

    /// How long a bar is, and what hangs on it at the right.
    void find_bar(std::size_t b) {
        Taps& taps = taps_[b];
        auto const last = [&](std::set<std::size_t> const& slots) {
            return slots.empty() ? -1.0 : first_tap_ + pitch_ * static_cast<double>(*slots.rbegin());
        };
        double const left = std::max(last(taps.left), taps.source != nullptr ? first_tap_ : -1),
                     right = last(taps.right);
        double y = right < 0 ? first_tap_ : right + below_ + 10;
        for (Grid::Device const* device : taps.devices) {
            out_.devices.push_back({device, {0, y}, false}); // y is from the bar's top as yet
            y += kDeviceRow;
        }
        double const devices = taps.devices.empty() ? -1 : y - kDeviceRow;
        taps.bottom = std::max({30.0, left + 12, right + 12, devices + 12});
        taps.block = std::max({taps.bottom, left + below_, right + below_});
        if (auto const own =
                std::count_if(grid_.faults.begin(), grid_.faults.end(),
                              [&](auto const& f) { return f.line.empty() && f.bus == grid_.buses[b].name; });
            own > 0) { // below all that belongs to it
            taps.bottom = taps.block;
            taps.block += 22 + kFaultRow * static_cast<double>(own);
        }
    }

    /// `needs`: below the rows, for branches that go down.
    void place_rows(std::vector<double> const& heights, std::vector<double> const& needs) {
        double y = kLabelRoom;
        for (std::size_t r = 0; r < rows_; ++r) {
            tops_.push_back(y);
            lane_tops_.push_back(y + heights[r] + std::max(kBetweenRows, needs[r]));
            y = lane_tops_[r] + kLane * static_cast<double>(lanes_[r]) + kLabelRoom;
        }
        out_.height = lane_tops_.empty() ? 0 : y - kLabelRoom;
    }

    /// The symbols of both ends.
    void find_symbols(Run& run) {
        for (std::size_t end = 0; end < 2; ++end) {
            run.reach[end] = add_symbols(grid_, (end == 0) == run.turned ? "to" : "from", end, run.route);
        }
    }

    void find_widths() {
        std::vector<Gap> gaps(columns_ + 1); // before the first column, and behind each
        for (std::size_t b = 0; b < grid_.buses.size(); ++b) {
            make_room_for_bus(b, gaps[cells_[b].column], gaps[cells_[b].column + 1]);
        }
        std::vector<Turns> turns(columns_ + 1);
        for (Run& run : runs_) {
            if (run.kind == Way::Kind::upright) {
                make_room_for_upright(run, gaps[cells_[run.left].column], gaps[cells_[run.left].column + 1]);
                continue;
            }
            make_room_for_level(run, gaps);
            if (run.kind == Way::Kind::turns || run.kind == Way::Kind::loop || run.kind == Way::Kind::lane) {
                turns[cells_[run.left].column + 1].emplace_back(&run, 0);
            }
            if (run.kind == Way::Kind::late_turn || run.kind == Way::Kind::lane) {
                turns[cells_[run.right].column].emplace_back(&run, 1);
            }
        }
        place_columns(gaps, turns);
    }

    void make_room_for_bus(std::size_t b, Gap& before, Gap& behind) const {
        double const label = width_of(grid_.buses[b].label) + value_;
        before.name_before = std::max(before.name_before, is_tied(b) ? 0 : label / 2 + 6);
        behind.name_behind = std::max(behind.name_behind, is_tied(b) ? label + 14 : label / 2 + 6);
        if (taps_[b].source != nullptr) {
            before.before = std::max(before.before, 33 + std::max(17.0, width_of(taps_[b].source->label) / 2 + 6));
        }
        for (Grid::Device const* device : taps_[b].devices) {
            behind.beside =
                std::max(behind.beside, kStub + label_offset(shape_of(device->kind)) + width_of(device->label) + 10 +
                                            (value_ > 0 ? room_of(shape_of(device->kind)) : 0));
        }
        for (Grid::Fault const& fault : grid_.faults) {
            if (fault.line.empty() && fault.bus == grid_.buses[b].name) {
                before.before = std::max(before.before, 34 + width_of(fault.name));
            }
        }
    }

    void make_room_for_upright(Run const& run, Gap& before, Gap& behind) const {
        double label = width_of(run.route.branch->label) + value_;
        for (Symbol const& s : run.route.symbols) {
            double wide = width_of(s.name) + 22;
            for (std::string const& tag : s.tags) {
                wide += width_of(tag) + 18;
            }
            label = std::max(label, wide);
        }
        behind.beside = std::max(behind.beside, label + 30);
        for (Grid::Fault const& fault : grid_.faults) {
            before.before =
                std::max(before.before, fault.line == run.route.branch->name ? width_of(fault.name) + 24 : 0);
        }
    }

    void make_room_for_level(Run const& run, std::vector<Gap>& gaps) const {
        Gap& behind = gaps[cells_[run.left].column + 1];
        double label = std::max(width_of(run.route.branch->label), value_);
        for (Grid::Fault const& fault : grid_.faults) {
            label = std::max(label, fault.line == run.route.branch->name ? 2 * (width_of(fault.name) + 18) : 0);
        }
        behind.symbols = std::max({behind.symbols, run.reach[0], run.kind == Way::Kind::loop ? run.reach[1] : 0});
        behind.label = std::max(behind.label, std::max(label, run.route.branch->kind == "transformer" ? 40 : 0.0) + 18);
        if (run.kind != Way::Kind::loop) {
            Gap& last = gaps[cells_[run.right].column];
            last.before = std::max(last.before, run.reach[1] + 4);
        }
    }

    void place_columns(std::vector<Gap>& gaps, std::vector<Turns>& turns) {
        double x = kMargin + std::max(gaps[0].before, gaps[0].name_before);
        for (std::size_t c = 0; c < columns_; ++c) {
            Gap& gap = gaps[c + 1];
            bool const last = c + 1 == columns_, turned = !turns[c + 1].empty();
            gap.before = last ? 0 : std::max(gap.before, turned ? gap.name_before : 10); // no track runs through a name
            gap.beside = std::max(
                {gap.beside, turned || last ? gap.name_behind : 0, gap.name_behind + gap.name_before - gap.before});
            gap.label = std::max(gap.label, gap.beside - gap.symbols);
            gap.tracks = turned ? 16 + kTrack * static_cast<double>(turns[c + 1].size()) : 0;
            x_.push_back(x);
            label_x_.push_back(x + gap.symbols + gap.label / 2);
            place_turns(turns[c + 1], x + gap.symbols + gap.label + 6);
            x += gap.symbols + gap.label + gap.tracks + gap.before;
        }
        out_.width = x + kMargin;
    }

    /// The heights between which a branch runs in its track.
    std::pair<double, double> turn_of(Run const& run, std::size_t which) const {
        double const y1 = tap(run.left, run.slots[0]), y2 = tap(run.right, run.slots[1]);
        return run.kind != Way::Kind::lane ? std::pair{y1, y2}
               : which == 0                ? std::pair{y1, lane_y(run)}
                                           : std::pair{lane_y(run), y2};
    }
    double lane_y(Run const& run) const {
        return lane_tops_[run.lane_row] + kLane * (static_cast<double>(run.lane) + 0.5);
    }

    /// Of branches that go down, the lowest turns first, of those that go up the highest: so they do not cross.
    void place_turns(Turns& turns, double x) {
        std::stable_sort(turns.begin(), turns.end(), [&](auto const& a, auto const& b) {
            auto const [ya, za] = turn_of(*a.first, a.second);
            auto const [yb, zb] = turn_of(*b.first, b.second);
            bool const down_a = za > ya, down_b = zb > yb;
            return down_a != down_b ? down_a : down_a ? ya > yb : ya < yb;
        });
        for (auto& [run, which] : turns) {
            run->tracks[which] = x += kTrack;
        }
    }

    bool is_tied(std::size_t bus) const {
        return std::any_of(runs_.begin(), runs_.end(),
                           [&](Run const& r) { return r.kind == Way::Kind::upright && r.right == bus; });
    }

    void draw_routes() {
        for (Run& run : runs_) {
            double const x1 = x_[cells_[run.left].column], x2 = x_[cells_[run.right].column];
            Route& route = run.route;
            if (run.kind == Way::Kind::upright) {
                draw_upright(run, x1);
            } else {
                double const y1 = tap(run.left, run.slots[0]), y2 = tap(run.right, run.slots[1]);
                double const first = run.tracks[0], last = run.tracks[1];
                switch (run.kind) {
                case Way::Kind::turns:
                case Way::Kind::loop:
                    route.path = {{x1, y1}, {first, y1}, {first, y2}, {x2, y2}};
                    break;
                case Way::Kind::late_turn:
                    route.path = {{x1, y1}, {last, y1}, {last, y2}, {x2, y2}};
                    break;
                case Way::Kind::lane:
                    route.path = {{x1, y1},   {first, y1}, {first, lane_y(run)}, {last, lane_y(run)},
                                  {last, y2}, {x2, y2}};
                    break;
                default:
                    route.path = {{x1, y1}, {x2, y2}};
                }
                route.label = {label_x_[cells_[run.left].column], y1};
                bool const turns = route.path.size() > 2; // then the piece before the first turn has the room
                route.bare = {Point{x1 + run.reach[0], y1}, Point{turns ? route.path[1].x - 6 : x2 - run.reach[1], y1}};
                for (Symbol& s : route.symbols) {
                    bool const second = s.at.y != 0, leftwards = second && run.kind != Way::Kind::loop;
                    double const bar = second ? x2 : x1, sign = leftwards ? -1 : 1;
                    s.at = {bar + sign * s.at.x, second ? y2 : y1};
                    for (double& tag : s.tags_x) {
                        tag = bar + sign * tag;
                    }
                }
            }
            if (run.turned) {
                std::reverse(route.path.begin(), route.path.end());
                std::swap(route.bare[0], route.bare[1]);
            }
            out_.routes.push_back(std::move(route));
        }
    }

    /// From the upper bar down: its symbols, the label, those of the lower bar.
    void draw_upright(Run& run, double x) {
        Route& route = run.route;
        double const from = top(run.left) + taps_[run.left].bottom, to = top(run.right);
        route.path = {{x, from}, {x, to}};
        double down = top(run.left) + taps_[run.left].block + 12,
               up = to - 34; // above the lower bar its label has to stand
        route.bare = {Point{x, down - 8}, Point{x, up}};
        for (Symbol& s : route.symbols) {
            bool const second = s.at.y != 0;
            double& y = second ? up : down;
            s.at = {x, y};
            y += second ? -kUprightRow : kUprightRow;
            double tag_x = x + 14 + width_of(s.name);
            for (std::size_t t = 0; t < s.tags.size(); ++t) {
                s.tags_x[t] = tag_x + 9 + width_of(s.tags[t]) / 2;
                tag_x += 18 + width_of(s.tags[t]);
            }
        }
        route.label = {x, (down + up) / 2};
    }

    Grid const& grid_;
    double value_; ///< room for what is measured: behind a label, or above a branch in a row of its own
    double above_, first_tap_;
    std::vector<Cell> cells_;
    std::map<std::string, std::size_t> number_;
    std::size_t columns_{0}, rows_{0};
    std::vector<Run> runs_;
    std::vector<Taps> taps_;
    std::vector<std::size_t> lanes_;
    double below_{kBelow}, pitch_{0};
    std::vector<double> tops_, lane_tops_, x_, label_x_;
    Layout out_;
};

} // namespace

Point Route::at(double share) const {
    return {bare[0].x + share * (bare[1].x - bare[0].x), bare[0].y + share * (bare[1].y - bare[0].y)};
}

Layout lay_out(Grid const& grid, bool live) {
    return Layouter{grid, live}.lay_out();
}

} // namespace gridspace::diagram
