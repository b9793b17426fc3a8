// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/fmu/grid_fmu.hpp"

#include "common/text.hpp"
#include "common/version.hpp"
#include "fmi/description_writer.hpp"
#include "launcher/folder/sha256.hpp"
#include "sim/fmu/fmu_settings.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using fmi::Causality;
using fmi::Type;
using fmi::Variability;

/// Folder of the binaries for the machine that this program was compiled for.
#if defined(__aarch64__)
constexpr std::string_view kPlatform = "aarch64-linux";
#else
constexpr std::string_view kPlatform = "x86_64-linux";
#endif

std::optional<double> finite(double bound) {
    return std::isfinite(bound) ? std::optional{bound} : std::nullopt;
}

fmi::Variable to_variable(sim::GridInput const& input) {
    fmi::Variable v;
    v.name = input.name;
    v.type = input.is_command ? Type::boolean : input.modes.empty() ? Type::float64 : Type::enumeration;
    v.items = input.modes;
    v.causality = Causality::input;
    v.variability = Variability::discrete; // held from set to set: nobody interpolates between two
    v.unit = input.unit;
    v.description = input.doc;
    v.start = !input.is_command ? shortest(input.start) : input.on_at_start ? "true" : "false";
    v.min = finite(input.range.min);
    v.max = finite(input.range.max);
    return v;
}

fmi::Variable to_variable(sim::SignalDef const& signal) {
    fmi::Variable v;
    v.name = signal.name;
    v.causality = Causality::output;
    v.unit = signal.unit;
    if (signal.may_be_unknown) {
        v.description = "NaN until something has happened";
    } else if (signal.unit == "dpc") {
        v.description = "position by IEC 61850-7-3: intermediate 0, open 1, closed 2";
    }
    return v;
}

fmi::ModelDescription describe_grid(GridToExport const& grid) {
    fmi::ModelDescription d;
    d.version_text = "3.0";
    d.name = grid.name;
    d.tool = "Gridspace " + std::string{version().version};
    d.co_simulation = fmi::CoSimulation{.identifier = model_identifier(grid.name),
                                        .variable_step = true,
                                        .fixed_internal_step_s = grid.engine.step_s.to_double()};
    d.start_s = 0;
    d.stop_s = grid.stop_s.to_double();
    d.step_s = grid.engine.step_s.to_double();
    fmi::Variable time;
    time.name = "time";
    time.causality = Causality::independent;
    time.unit = "s";
    d.variables.push_back(std::move(time));
    for (sim::GridInput const& input : grid.inputs) {
        d.variables.push_back(to_variable(input));
    }
    for (sim::SignalDef const& signal : grid.outputs) {
        d.variables.push_back(to_variable(signal));
    }
    for (std::size_t i = 0; i < d.variables.size(); ++i) {
        d.variables[i].reference = static_cast<std::uint32_t>(i);
    }
    return d;
}

/// Of all that the description and the resources say: another network, or another choice of variables, has another.
std::string token_of(fmi::ModelDescription const& description, sim::FmuSettings const& settings,
                     std::vector<fmi::ArchiveFile> const& files) {
    std::string all = fmi::write_model_description(description) + sim::to_yaml(settings);
    for (fmi::ArchiveFile const& file : files) {
        all += file.name + sha256_of_text(file.content);
    }
    return sha256_of_text(all);
}

} // namespace

std::string model_identifier(std::string const& name) {
    std::string out = as_file_name(name);
    std::replace(out.begin(), out.end(), '-', '_');
    bool const begins_well = !out.empty() && std::isdigit(static_cast<unsigned char>(out.front())) == 0;
    return begins_well ? out : "grid_" + out;
}

Result<std::string> make_grid_fmu(GridToExport const& grid) {
    fmi::ModelDescription description = describe_grid(grid);
    sim::FmuSettings settings;
    settings.engine = grid.engine;
    settings.network = grid.files.front().name;
    for (fmi::Variable const& v : description.variables) {
        if (v.causality != Causality::independent) {
            (v.causality == Causality::input ? settings.inputs : settings.outputs).push_back(v.name);
        }
    }
    description.token = settings.token = token_of(description, settings, grid.files);
    std::vector<fmi::ArchiveFile> all{
        {"modelDescription.xml", fmi::write_model_description(description)},
        {fmt::format("binaries/{}/{}.so", kPlatform, description.co_simulation->identifier), grid.binary},
        {fmt::format("resources/{}", sim::FmuSettings::kFile), sim::to_yaml(settings)}};
    for (fmi::ArchiveFile const& file : grid.files) {
        all.push_back({"resources/" + file.name, file.content});
    }
    return fmi::make_archive(all);
}

} // namespace gridspace::launcher
