// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-fmu, as the launcher sees it: its settings checked against what the FMU says of itself. Nothing of it is
// run.
#include "agents/fmu/fmu_declaration.hpp"
#include "bus/topics.hpp"
#include "fmi/archive.hpp"
#include "launcher/scenario/declared_program.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_programs.hpp"

namespace gridspace::launcher {
namespace {

using agents::FmuConfig;
using config::Diagnostics;

class FmuSettings final : public DeclaredSettings {
  public:
    explicit FmuSettings(config::Fields& f) : DeclaredSettings{agents::fmu_declaration()} { describe(f, config_); }

    void settle(Scenario const&, Process const&) override { declare(agents::declaration(config_, {}, {})); }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_whole_steps(s, process, diagnostics);
        auto const complain = [&](Error const& error) {
            diagnostics.error(config_.fmu_at, error.message, error.remedy);
        };
        if (config_.fmu.empty()) {
            return; // said already
        }
        auto const archive = fmi::Archive::open(config_.fmu);
        if (!archive) {
            return complain(archive.error());
        }
        auto const description = fmi::read_model_description(*archive, config_.fmu.filename().string());
        if (!description) {
            return complain(description.error());
        }
        if (auto const binary = fmi::binary_of(*archive, *description); !binary) {
            return complain(binary.error());
        }
        auto const table = agents::make_table(config_, *description, process.name.name, bus::idl_of_type, diagnostics);
        declare(agents::declaration(config_, *description, table)); // what is watched is known now
    }

  private:
    FmuConfig config_;
};

} // namespace

std::unique_ptr<ProcessSettings> read_fmu(config::Fields& f) {
    return std::make_unique<FmuSettings>(f);
}

} // namespace gridspace::launcher
