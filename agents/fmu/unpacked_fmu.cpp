// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/fmu/unpacked_fmu.hpp"

#include "fmi/archive.hpp"

#include <fmt/format.h>

namespace gridspace::agents {

Result<std::unique_ptr<UnpackedFmu>> UnpackedFmu::open(std::filesystem::path const& file, std::string const& process) {
    auto const archive = fmi::Archive::open(file);
    if (!archive) {
        return std::unexpected{archive.error()};
    }
    auto description = fmi::read_model_description(*archive, file.filename().string());
    if (!description) {
        return std::unexpected{description.error()};
    }
    auto binary = fmi::binary_of(*archive, *description);
    if (!binary) {
        return std::unexpected{binary.error()};
    }
    std::unique_ptr<UnpackedFmu> out{new UnpackedFmu};
    out->folder_ = std::filesystem::current_path() / (".gridspace-fmu-" + process);
    std::error_code failed;
    std::filesystem::remove_all(out->folder_, failed);                       // of one that was killed
    std::filesystem::create_directories(out->folder_ / "resources", failed); // an FMU without any gets it as well
    if (failed) {
        return fail(ExitCode::environment,
                    fmt::format("cannot make the folder '{}': {}", out->folder_.string(), failed.message()),
                    "the FMU is unpacked in the folder that the process runs in");
    }
    out->binary_ = std::move(*binary);
    out->description_ = std::move(*description);
    if (auto ok = archive->unpack(out->folder_); !ok) {
        return std::unexpected{ok.error()};
    }
    return out;
}

UnpackedFmu::~UnpackedFmu() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

Result<std::unique_ptr<fmi::Instance>> UnpackedFmu::instantiate(std::string const& name, fmi::Host& host) const {
    return fmi::instantiate(description_, folder_, binary_, name, host);
}

} // namespace gridspace::agents
