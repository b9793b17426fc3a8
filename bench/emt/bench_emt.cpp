// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Cost of a waveform step: the protection case, WSCC 9-bus with full machines, feeders of growing size, meshed grids of
// a thousand buses on one and two threads; and ngspice on the same circuit in the same run, with the error of both
// against a fine solution.
#include "common/config/diagnostics.hpp"
#include "common/source_tree.hpp"
#include "common/team.hpp"
#include "sim/emt/emt_engine.hpp"
#include "sim/emt/solver.hpp"
#include "sim/network/network_config.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <sstream>
#include <sys/resource.h>
#include <unistd.h>

using namespace gridspace;
using namespace gridspace::sim;
using Clock = std::chrono::steady_clock;

namespace {

constexpr double kStep = 1.0 / 48000;

/// Processor time of this program, or of the children that ended: other work on the machine does not count.
double cpu_s(int who) {
    rusage used{};
    ::getrusage(who, &used);
    auto const seconds = [](timeval const& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double seconds_since(Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
}

std::string only; ///< rows whose name has this

/// `read`: the signals that somebody reads begin with it; their values are read every tenth step, as a merging unit
/// does.
void measure(std::string const& name, Network network, int steps, std::string const& read,
             Rational step_s = Rational{1, 48000}, int threads = 1) {
    if (name.find(only) == std::string::npos) {
        return;
    }
    TimeBase const base{step_s};
    std::size_t const buses = network.buses.size();
    std::shared_ptr<Team> team = threads > 1 ? make_thread_team(threads) : nullptr;
    auto engine = emt::make_emt_engine(std::move(network), {base, SimSpan{1}, 0, std::move(team)});
    if (!engine || !(*engine)->initialise()) {
        fmt::print("{}: cannot start\n", name);
        return;
    }
    std::vector<std::size_t> signals;
    for (std::size_t i = 0; i < (*engine)->signals().size(); ++i) {
        if ((*engine)->signals()[i].name.starts_with(read)) {
            signals.push_back(i);
        }
    }
    (*engine)->will_read(signals);
    double sum = 0;
    std::vector<double> us;
    us.reserve(static_cast<std::size_t>(steps));
    for (int k = 1; k <= steps; ++k) {
        auto const begin = Clock::now();
        if (!(*engine)->advance(SimTime{k})) {
            fmt::print("{}: failed\n", name);
            return;
        }
        for (std::size_t i = 0; k % 10 == 0 && i < signals.size(); ++i) {
            sum += (*engine)->value(signals[i]);
        }
        us.push_back(1e6 * seconds_since(begin));
    }
    if (std::isinf(sum)) { // NaN: a value that is not known yet
        fmt::print("{}: no numbers\n", name);
    }
    std::sort(us.begin(), us.end());
    auto const at = [&](double share) { return us[static_cast<std::size_t>(share * (steps - 1))]; };
    fmt::print("{:<33} {:>5} buses  p50 {:>8.2f}  p99 {:>8.2f}  p99.9 {:>8.2f} us per step  {:>7.1f} x real time\n",
               name, buses, at(0.5), at(0.99), at(0.999), 1e6 * step_s.to_double() / at(0.5));
}

Network loaded(std::string const& file) {
    config::Diagnostics diagnostics;
    auto network = load_network(source_tree(file), diagnostics);
    if (!network) {
        fmt::print("{}\n", diagnostics.render());
        std::exit(1);
    }
    return std::move(*network);
}

Network shipped(std::string const& file) {
    return loaded("configs/networks/" + file);
}

/// Copies of the IEEE 118-bus system in a ring, three ties from each to the next: loads and generators are converters.
/// One of them has the slack.
Network meshed(int copies) {
    Network const one = loaded("tests/golden/powerflow/case118.m");
    Network n = one;
    auto const named = [](config::Ref ref, int copy) {
        ref.name += fmt::format("_{}", copy);
        return ref;
    };
    auto const add = [&](auto Elements::* kind, auto const& rename) {
        (n.*kind).clear();
        for (int copy = 0; copy < copies; ++copy) {
            for (auto element : one.*kind) {
                element.name = named(element.name, copy);
                rename(element, copy);
                (n.*kind).push_back(element);
            }
        }
    };
    auto const at_bus = [&](auto& element, int copy) { element.bus = named(element.bus, copy); };
    auto const between = [&](auto& element, int copy) {
        element.from = named(element.from, copy);
        element.to = named(element.to, copy);
    };
    add(&Elements::buses, [](auto&, int) {});
    add(&Elements::loads, at_bus);
    add(&Elements::shunts, at_bus);
    add(&Elements::generators, [&](Generator& generator, int copy) {
        at_bus(generator, copy);
        if (copy > 0 && generator.role == GeneratorRole::slack) {
            generator.role = GeneratorRole::pv;
        }
    });
    add(&Elements::lines, between);
    add(&Elements::transformers, between);
    for (int copy = 0; copy < copies; ++copy) {
        for (std::size_t const bus : {11, 58, 99}) {
            Line tie;
            tie.name.name = fmt::format("tie_{}_{}", copy, bus);
            tie.from = named(one.buses[bus].name, copy);
            tie.to = named(one.buses[bus].name, (copy + 1) % copies);
            tie.r_ohm = 2;
            tie.x_ohm = 20;
            tie.c_nf = 200;
            n.lines.push_back(tie);
        }
    }
    return n;
}

/// At the first bus.
void add_source(Network& n, double r_ohm, double l_mh) {
    Source source;
    source.name.name = "S";
    source.bus = n.buses.front().name;
    source.r_ohm = r_ohm;
    source.l_mh = l_mh;
    n.sources.push_back(source);
}

/// side x side buses, each with a line to the right and one down, a load of constant power, and every fourth a
/// generator.
Network lattice(int side) {
    Network n;
    n.name = "lattice";
    n.power_kva = 1000;
    auto const bus_of = [&](int row, int column) {
        return n.buses[static_cast<std::size_t>(row * side + column)].name;
    };
    for (int i = 0; i < side * side; ++i) {
        Bus bus;
        bus.name.name = fmt::format("B{}", i);
        bus.voltage_v = 12470;
        n.buses.push_back(bus);
        Load load;
        load.name.name = fmt::format("D{}", i);
        load.bus = bus.name;
        load.p_kw = 50;
        load.power_factor = 0.95;
        n.loads.push_back(load);
        if (i % 4 == 1) {
            Generator generator;
            generator.name.name = fmt::format("G{}", i);
            generator.bus = bus.name;
            generator.role = GeneratorRole::pq;
            generator.rating_kva = 250;
            generator.p_kw = 190;
            n.generators.push_back(generator);
        }
    }
    for (int i = 0; i < side * side; ++i) {
        int const row = i / side, column = i % side;
        for (int const down : {0, 1}) {
            if ((down == 0 ? column : row) + 1 < side) {
                Line line;
                line.name.name = fmt::format("L{}_{}", i, down);
                line.from = bus_of(row, column);
                line.to = bus_of(row + down, column + 1 - down);
                line.r_ohm = 0.1;
                line.l_mh = 0.6;
                line.c_nf = 20;
                line.r0_ohm = 0.3;
                line.l0_mh = 1.8;
                n.lines.push_back(line);
            }
        }
    }
    add_source(n, 0.05, 0.5);
    return n;
}

/// A source and a radial feeder: every tenth bus begins a lateral, every bus has a load. `parts`: cut into so many of
/// equal size, each behind a travelling-wave line from the first bus of the one before.
Network feeder(int buses, int parts = 1) {
    Network n;
    n.name = fmt::format("feeder {}", buses);
    n.frequency_hz = 60;
    n.power_kva = 1000;
    for (int i = 0; i < buses; ++i) {
        Bus bus;
        bus.name.name = fmt::format("B{}", i);
        bus.voltage_v = 12470;
        n.buses.push_back(bus);
        Load load;
        load.name.name = fmt::format("D{}", i);
        load.bus = bus.name;
        load.p_kw = 2000.0 / buses;
        load.power_factor = 0.95;
        load.model = LoadModel::constant_impedance;
        n.loads.push_back(load);
        if (i > 0) {
            Line line;
            line.name.name = fmt::format("L{}", i);
            line.from = n.buses[static_cast<std::size_t>(i % 10 == 0 ? i - 10 : i - 1)].name;
            line.to = bus.name;
            line.r_ohm = 0.05;
            line.l_mh = 0.3;
            if (int const part = buses / parts; i % part == 0) { // 25 km: 83 us
                line.from = n.buses[static_cast<std::size_t>(i - part)].name;
                line.model = LineModel::bergeron;
                line.r_ohm = 1;
                line.l_mh = 25;
                line.c_nf = 280;
            }
            n.lines.push_back(line);
        }
    }
    add_source(n, 0.1, 2);
    return n;
}

/// Energising twelve coupled sections with a load, from rest.
emt::Circuit ladder() {
    emt::Circuit c;
    int at = c.add_triple("s");
    c.sources.push_back({at, 100, 0, 60, {}, "S"});
    int const first = c.add_triple("begin");
    c.switches.push_back({at, first, {false, false, false}, {}, "CB"});
    at = first;
    for (int k = 0; k < 12; ++k) {
        int const next = c.add_triple("n");
        c.rl.push_back({at, next, emt::PhaseMatrix::sequence(0.3, 0.3), emt::PhaseMatrix::sequence(1.5e-3, 3e-3)});
        c.capacitors.push_back({next, emt::kEarth, emt::PhaseMatrix::sequence(10e-6, 10e-6)});
        at = next;
    }
    c.rl.push_back({at, emt::kEarth, emt::PhaseMatrix::sequence(10, 10), {}});
    return c;
}

/// Voltage of the last node, phase a, every 1/4800 s; and the processor time.
std::pair<std::vector<double>, double> ours(double h, int per_sample, int samples) {
    emt::Solver solver{ladder(), h};
    (void)solver.start({});
    solver.close_switch(0);
    std::vector<double> v;
    double const begin = cpu_s(RUSAGE_SELF);
    for (int s = 0; s < samples; ++s) {
        for (int k = 0; k < per_sample; ++k) {
            (void)solver.advance(solver.t() + h, h);
        }
        v.push_back(solver.node_voltage(solver.circuit().nodes() - 3));
    }
    return {v, cpu_s(RUSAGE_SELF) - begin};
}

std::pair<std::vector<double>, double> ngspice(int samples) {
    auto const folder = std::filesystem::temp_directory_path() / fmt::format("gridspace-bench-{}", ::getpid());
    std::filesystem::create_directories(folder);
    std::ofstream in{folder / "b.cir"};
    in << "bench\nVa a0 0 SIN(0 100 60 0 0 90)\nVb b0 0 SIN(0 100 60 0 0 -30)\nVc c0 0 SIN(0 100 60 0 0 210)\n";
    for (int k = 1; k <= 12; ++k) {
        for (char const p : {'a', 'b', 'c'}) {
            in << fmt::format("L{0}{1} {0}{2} {0}x{1} 2m IC=0\nR{0}{1} {0}x{1} {0}{1} 0.3\nC{0}{1} {0}{1} 0 10u IC=0\n",
                              p, k, k - 1);
        }
        in << fmt::format("Kab{0} La{0} Lb{0} 0.25\nKbc{0} Lb{0} Lc{0} 0.25\nKac{0} La{0} Lc{0} 0.25\n", k);
    }
    in << "RLa a12 0 10\nRLb b12 0 10\nRLc c12 0 10\n"
       << fmt::format(".control\nset wr_singlescale\ntran {0} {1} 0 {0} uic\nwrdata {2} v(a12)\nquit\n.endc\n.end\n",
                      kStep, samples / 4800.0 + 1e-3, (folder / "out.txt").string());
    in.close();
    double const begin = cpu_s(RUSAGE_CHILDREN);
    int const failed = std::system(fmt::format("ngspice -b {} > /dev/null 2>&1", (folder / "b.cir").string()).c_str());
    double const cpu = cpu_s(RUSAGE_CHILDREN) - begin;
    std::vector<double> v;
    std::ifstream file{folder / "out.txt"};
    double t0 = 0, v0 = 0, next = 1.0 / 4800;
    for (std::string line; failed == 0 && std::getline(file, line) && v.size() < static_cast<std::size_t>(samples);) {
        std::istringstream fields{line};
        double t = 0, x = 0;
        fields >> t >> x;
        while (t >= next && v.size() < static_cast<std::size_t>(samples)) {
            v.push_back(t > t0 ? v0 + (x - v0) * (next - t0) / (t - t0) : x);
            next = static_cast<double>(v.size() + 1) / 4800;
        }
        t0 = t;
        v0 = x;
    }
    std::filesystem::remove_all(folder);
    return {v, cpu};
}

double error(std::vector<double> const& a, std::vector<double> const& b) {
    double worst = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
        worst = std::max(worst, std::abs(a[i] - b[i]));
    }
    return worst;
}

} // namespace

/// A word: only the rows whose name has it, and no ngspice.
int main(int count, char** words) {
    only = count > 1 ? words[1] : "";
    measure("protection (case 2)", shipped("adn_set_a.yaml"), 96000, "ct.");
    measure("the same, all signals", shipped("adn_set_a.yaml"), 96000, "");
    measure("WSCC 9-bus, 3 machines", shipped("wscc9.yaml"), 48000, "bus.");
    for (int const buses : {10, 30, 100, 300}) {
        measure(fmt::format("feeder"), feeder(buses), 48000000 / (1000 * buses), "line.");
    }
    for (int const parts : {1, 10, 50}) {
        measure(fmt::format("feeder in {} parts, 50 us", parts), feeder(1000, parts), 20000, "line.L1.",
                Rational{1, 20000});
    }
    Rational const fifty{1, 20000};
    for (int const threads : {1, 2}) {
        measure(fmt::format("9 x case118, threads: {}, 50 us", threads), meshed(9), 10000, "bus.69_0.v", fifty,
                threads);
        measure(fmt::format("lattice, threads: {}, 50 us", threads), lattice(32), 10000, "bus.B1.v", fifty, threads);
        measure(fmt::format("feeder in 10, threads: {}, 50 us", threads), feeder(1000, 10), 20000, "line.L1.", fifty,
                threads);
    }
    if (!only.empty()) {
        return 0;
    }
    if (std::system("command -v ngspice > /dev/null 2>&1") != 0) {
        fmt::print("ngspice is not installed: no baseline\n");
        return 0;
    }
    constexpr int kSamples = 4800; // one second
    auto const [fine, unused] = ours(kStep / 32, 320, kSamples);
    (void)unused;
    auto const [mine, my_cpu] = ours(kStep, 10, kSamples);
    auto const [spice, spice_cpu] = ngspice(kSamples);
    fmt::print("\n12 coupled three-phase sections energised, 1 s at {:.2f} us:\n", 1e6 * kStep);
    fmt::print("  gridspace {:>8.4f} s, largest error {:.3f} V of 100\n", my_cpu, error(mine, fine));
    fmt::print("  ngspice   {:>8.4f} s, largest error {:.3f} V of 100: {:.0f} times slower\n", spice_cpu,
               error(spice, fine), spice_cpu / my_cpu);
    return 0;
}
