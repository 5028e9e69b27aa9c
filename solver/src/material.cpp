// SPDX-License-Identifier: Apache-2.0
// Measured fabrics. Wang, O'Brien, Ramamoorthi 2011, "Data-Driven Elastic Models for Cloth: Modeling and Measurement":
// the coefficients of their database as ARCSim distributes it, taken at small strain and small curvature (first sample
// of each table): c11 along weft, c22 along warp, half of c33 for shear, the first bending sample along warp and weft.
// Their cloth stiffens as it stretches; ours does not.

#include "geocloth/solver/material.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "material_fields.h"

namespace geocloth {
namespace {

struct Measured {
  float areal_density, stretch_warp, stretch_weft, shear, bend_warp, bend_weft;
};

constexpr Material material_of(const Measured& m) {
  Material material;
  material.areal_density = m.areal_density;
  material.stretch_warp = m.stretch_warp;
  material.stretch_weft = m.stretch_weft;
  material.shear = m.shear;
  material.bend_warp = m.bend_warp;
  material.bend_weft = m.bend_weft;
  return material;
}

constexpr const char* kDenim = "Wang et al. 2011, fabric \"11oz Black Denim\" (ARCSim 11oz-black-denim.json)";
constexpr const char* kInterlock = "Wang et al. 2011, fabric \"Gray Interlock\" (ARCSim gray-interlock.json)";
constexpr const char* kRib = "Wang et al. 2011, fabric \"Ivory Rib Knit\" (ARCSim ivory-rib-knit.json)";
constexpr const char* kSweat = "Wang et al. 2011, fabric \"Navy Sparkle Sweat\" (ARCSim navy-sparkle-sweat.json)";
constexpr const char* kPonte = "Wang et al. 2011, fabric \"Camel Ponte Roma\" (ARCSim camel-ponte-roma.json)";
constexpr const char* kJetSet = "Wang et al. 2011, fabric \"Tango Red Jet Set\" (ARCSim tango-red-jet-set.json)";
constexpr const char* kRibbon = "Wang et al. 2011, fabric \"Pink Ribbon Brown\" (ARCSim pink-ribbon-brown.json)";
constexpr const char* kDots = "Wang et al. 2011, fabric \"White Dots on Black\" (ARCSim white-dots-on-blk.json)";
constexpr const char* kCotton =
    "Wang et al. 2011, fabric \"Royal Target\" (ARCSim royal-target.json): the firm woven of the database stands for "
    "woven cotton";

constexpr std::array<MaterialPreset, 9> kPresets{{
    {"cotton", material_of({0.220F, 2034.98F, 2016.55F, 52.4F, 125.4e-6F, 125.4e-6F}), kCotton},
    {"denim", material_of({0.324F, 1013.89F, 205.35F, 26.7F, 64.2e-6F, 96.95e-6F}), kDenim},
    {"interlock_knit", material_of({0.187F, 34.48F, 16.59F, 18.4F, 23.19e-6F, 14.27e-6F}), kInterlock},
    {"rib_knit", material_of({0.276F, 65.17F, 42.87F, 41.6F, 46.24e-6F, 32.24e-6F}), kRib},
    {"sweat_knit", material_of({0.224F, 3.27F, 12.49F, 8.81F, 59.47e-6F, 45.63e-6F}), kSweat},
    {"ponte_knit", material_of({0.284F, 44.03F, 31.15F, 15.9F, 36.35e-6F, 37.16e-6F}), kPonte},
    {"jet_set", material_of({0.113F, 171.42F, 43.07F, 7.16F, 14.29e-6F, 20.35e-6F}), kJetSet},
    {"ribbon", material_of({0.228F, 244.83F, 151.50F, 15.1F, 117.1e-6F, 59.77e-6F}), kRibbon},
    {"dotted_woven", material_of({0.128F, 2027.49F, 2002.09F, 9.59F, 51.71e-6F, 31.28e-6F}), kDots},
}};

}  // namespace

std::span<const MaterialPreset> material_presets() {
  return kPresets;
}

const MaterialPreset* find_material_preset(std::string_view name) {
  const auto* at = std::find_if(kPresets.begin(), kPresets.end(), [&](const auto& p) { return p.name == name; });
  return at == kPresets.end() ? nullptr : at;
}

Material mix(const Material& a, const Material& b, float t) {
  if (!(t > 0)) return a;
  if (t >= 1) return b;
  Material between = a;
  for (const MaterialField& field : kMaterialFields) {
    const float from = a.*field.value, to = b.*field.value;
    const bool one_is_none = field.none_at_zero && (from == 0 || to == 0);
    if (from == to || from < 0 || to < 0 || one_is_none) continue;
    const double share = t;
    if (from > 0 && to > 0) {
      between.*field.value = static_cast<float>(double{from} * std::pow(double{to} / double{from}, share));
    } else {
      const auto value = static_cast<float>(double{from} + share * (double{to} - double{from}));
      between.*field.value = value < field.least ? 0 : value;
    }
  }
  return between;
}

}  // namespace geocloth
