// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-gateway: a table of mappings between DDS topics and IEC 61850 streams, in all four directions.
#include "gateways/gateway/gateway.hpp"
#include "gateways/gateway/gateway_declaration.hpp"

int main(int argc, char** argv) {
    using namespace gridspace::gateways;
    GatewaySettings settings;
    GatewayProgram const program{
        gateway_declaration, [&](gridspace::config::Fields& f) { describe(f, settings.gateway); }, {}, {}};
    return run_gateway(program, settings, argc, argv);
}
