// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/dss_classes.hpp"

#include <algorithm>
#include <map>
#include <string>

/// Classes and properties of OpenDSS [OpenDSS manual, "DSS circuit element models"; `gridspace powerflow` reads them].
namespace gridspace::opendss {
namespace {

constexpr std::string_view kDelivery = " normamps emergamps faultrate pctperm repair basefreq enabled like";
constexpr std::string_view kConversion = " spectrum basefreq enabled like";
constexpr std::string_view kControl = " basefreq enabled like";
constexpr std::string_view kGeneral = " like";

struct Row {
    std::string_view name;
    std::string_view properties, inherited;
};

constexpr Row kModelled[] = {
    {"line",
     "bus1 bus2 linecode length phases r1 x1 r0 x0 c1 c0 rmatrix xmatrix cmatrix switch rg xg rho geometry units "
     "spacing wires earthmodel cncables tscables b1 b0 seasons ratings linetype epsrmedium heightoffset heightunit "
     "conductors",
     kDelivery},
    {"linecode",
     "nphases r1 x1 r0 x0 c1 c0 units rmatrix xmatrix cmatrix basefreq normamps emergamps faultrate pctperm repair "
     "kron rg xg rho neutral b1 b0 seasons ratings linetype",
     kGeneral},
    {"load",
     "phases bus1 kv kw pf model yearly daily duty growth conn kvar rneut xneut status class vminpu vmaxpu vminnorm "
     "vminemerg xfkva allocationfactor kva %mean %stddev cvrwatts cvrvars kwh kwhdays cfactor cvrcurve numcust zipv "
     "%seriesrl relweight vlowpu puxharm xrharm",
     kConversion},
    {"transformer",
     "phases windings wdg bus conn kv kva tap %r rneut xneut buses conns kvs kvas taps xhl xht xlt xscarray thermal n "
     "m flrise hsrise %loadloss %noloadloss normhkva emerghkva sub maxtap mintap numtaps subname %imag ppm_antifloat "
     "%rs bank xfmrcode xrconst x12 x13 x23 leadlag wdgcurrents core rdcohms seasons ratings",
     kDelivery},
    {"xfmrcode",
     "phases windings wdg conn kv kva tap %r rneut xneut conns kvs kvas taps xhl xht xlt xscarray thermal n m flrise "
     "hsrise %loadloss %noloadloss normhkva emerghkva maxtap mintap numtaps %imag ppm_antifloat %rs x12 x13 x23 "
     "rdcohms seasons ratings",
     kGeneral},
    {"regcontrol",
     "transformer winding vreg band ptratio ctprim r x bus delay reversible revvreg revband revr revx tapdelay "
     "debugtrace maxtapchange inversetime tapwinding vlimit ptphase revthreshold revdelay revneutral eventlog "
     "remoteptratio tapnum reset ldc_z rev_z cogen",
     kControl},
    {"capcontrol",
     "element terminal capacitor type ptratio ctratio onsetting offsetting delay voltoverride vmax vmin delayoff "
     "deadtime ctphase ptphase vbus eventlog usermodel userdata pctminkvar reset",
     kControl},
    {"capacitor", "bus1 bus2 phases kvar kv conn cmatrix cuf r xl harm numsteps states", kDelivery},
    {"reactor", "bus1 bus2 phases kvar kv conn rmatrix xmatrix parallel r x rp z1 z2 z0 z rcurve lcurve lmh",
     kDelivery},
    {"vsource",
     "bus1 basekv pu angle frequency phases mvasc3 mvasc1 x1r1 x0r0 isc3 isc1 r1 x1 r0 x0 scantype sequence bus2 z1 z0 "
     "z2 puz1 puz0 puz2 basemva yearly daily duty model puzideal",
     kConversion},
    {"generator",
     "phases bus1 kv kw pf model yearly daily duty dispmode dispvalue conn kvar rneut xneut status class vpu maxkvar "
     "minkvar pvfactor debugtrace vminpu vmaxpu forceon kva mva xd xdp xdpp h d usermodel userdata shaftmodel "
     "shaftdata dutystart balanced xrdp",
     kConversion},
    {"pvsystem",
     "phases bus1 kv irradiance pmpp pctpmpp temperature pf conn kvar kva %cutin %cutout effcurve p-tcurve %r %x model "
     "vminpu vmaxpu balanced limitcurrent yearly daily duty tyearly tdaily tduty class usermodel userdata debugtrace "
     "varfollowinverter dutystart wattpriority pfpriority %pminnovars %pminkvarmax kvarmax kvarmaxabs",
     kConversion},
    {"wiredata", "rdc rac runits gmrac gmrunits radius radunits normamps emergamps diam seasons ratings capradius",
     kGeneral},
    {"linespacing", "nconds nphases x h units", kGeneral},
    {"linegeometry",
     "nconds nphases cond wire x h units normamps emergamps reduce spacing wires cncable tscable cncables tscables "
     "seasons ratings linetype",
     kGeneral},
    {"loadshape",
     "npts interval mult hour mean stddev csvfile sngfile dblfile action qmult useactual pmax qmax sinterval minterval "
     "pbase qbase pmult pqcsvfile memorymapping interpolation",
     kGeneral}};

constexpr std::string_view kWithoutEffect[] = {
    "cndata",   "cnlinegeometry", "energymeter", "fmonitor", "fuse",      "growthshape", "monitor", "priceshape",
    "recloser", "relay",          "sensor",      "spectrum", "tcc_curve", "tsdata",      "tshape",  "xycurve"};

constexpr std::string_view kLeftOut[] = {
    "autotrans",         "dynamicexp", "espvlcontrol",   "expcontrol",  "fault",      "gendispatcher", "generic5",
    "gicline",           "gicsource",  "gictransformer", "indmach012",  "invcontrol", "isource",       "storage",
    "storagecontroller", "swtcontrol", "upfc",           "upfccontrol", "vccs",       "windgen",       "vsconverter"};

std::map<std::string_view, ClassInfo> make_classes() {
    std::map<std::string_view, ClassInfo> out;
    for (Row const& row : kModelled) {
        ClassInfo info{row.name, Treatment::modelled, {}};
        for (std::string_view rest : {row.properties, row.inherited}) {
            while (!rest.empty()) {
                std::size_t const end = std::min(rest.find(' '), rest.size());
                if (end > 0) {
                    info.properties.push_back(rest.substr(0, end));
                }
                rest.remove_prefix(std::min(end + 1, rest.size()));
            }
        }
        out.emplace(row.name, std::move(info));
    }
    for (std::string_view const name : kWithoutEffect) {
        out.emplace(name, ClassInfo{name, Treatment::without_effect, {}});
    }
    for (std::string_view const name : kLeftOut) {
        out.emplace(name, ClassInfo{name, Treatment::left_out, {}});
    }
    return out;
}

std::map<std::string_view, ClassInfo> const& classes() {
    static std::map<std::string_view, ClassInfo> const kClasses = make_classes();
    return kClasses;
}

} // namespace

ClassInfo const* find_class(std::string_view name) {
    auto const it = classes().find(name);
    return it == classes().end() ? nullptr : &it->second;
}

std::vector<std::string_view> class_names() {
    std::vector<std::string_view> out;
    for (auto const& [name, info] : classes()) {
        out.push_back(name);
    }
    return out;
}

std::optional<std::size_t> find_property(ClassInfo const& info, std::string_view name) {
    auto const& all = info.properties;
    auto it = std::find(all.begin(), all.end(), name);
    if (it == all.end()) {
        it = std::find_if(all.begin(), all.end(), [&](std::string_view p) { return p.starts_with(name); });
    }
    return it == all.end() || name.empty() ? std::nullopt : std::optional{static_cast<std::size_t>(it - all.begin())};
}

} // namespace gridspace::opendss
