// SPDX-License-Identifier: MIT
#include "scoring/rules.h"

#include "core/vec.h"

namespace swallowclip::scoring {
namespace {
using R = ScoringRules;
constexpr double kMm = 1e-3, kMl = 1e-6, kOne = 1, kDeg = kPi / 180;
constexpr const char *kRise = "larynx_rise_ratio", *kGap = "vestibule_ratio_at_score",
                     *kBase = "tongue_base_gap_ratio",
                     *kWave = "wall_excursion_2,wall_excursion_3,wall_excursion_4",
                     *kBow = "side_wall_bulge_left,side_wall_bulge_right",
                     *kResidue = "oral_residue,pharyngeal_residue";

constexpr RuleField kFields[] = {
    {"stations", "ramus_mm", &R::ramus_m, kMm, 40, 120},
    {"stations", "ridge_end_mm", &R::ridgeEnd_m, kMm, 2, 30},
    {"stations", "ues_top_mm", &R::uesTop_m, kMm, 100, 200},
    {"stations", "ues_end_mm", &R::uesEnd_m, kMm, 120, 250},
    {"stations", "pharynx_top_mm", &R::pharynxTop_m, kMm, 60, 120},
    {"stations", "pharynx_end_mm", &R::pharynxEnd_m, kMm, 100, 200},

    {"events", "head_share", &R::headShare, kOne, 0.001, 0.5},
    {"events", "tail_share", &R::tailShare, kOne, 0.5, 1},
    {"events", "transit_share", &R::throughShare, kOne, 0.01, 1},
    {"events", "hyoid_burst_mm_per_s", &R::hyoidBurst_ms, kMm, 1, 100},
    {"events", "ues_open_mm", &R::uesOpen_m, kMm, 0.2, 5},
    {"events", "rest_speed_mm_per_s", &R::restSpeed_ms, kMm, 0.5, 50},
    {"events", "rest_hold_s", &R::restHold_s, kOne, 0, 2},
    {"events", "residue_speed_mm_per_s", &R::residueSpeed_ms, kMm, 1, 100},

    {"normal_swallow", "hyoid_anterior_mm", &R::normalHyoidAnterior_m, kMm, 1, 40},
    {"normal_swallow", "tongue_base_travel_mm", &R::normalTongueBase_m, kMm, 1, 30},
    {"normal_swallow", "shortening_mm", &R::normalShortening_m, kMm, 1, 60},
    {"normal_swallow", "larynx_rise_epiglottis_horizontal_mm", &R::normalRiseHorizontal_m, kMm, 0.5,
     60},
    {"normal_swallow", "larynx_rise_epiglottis_most_moved_mm", &R::normalRiseInverted_m, kMm, 0.5,
     60},
    {"normal_swallow", "larynx_rise_hyoid_onset_mm", &R::normalRiseOnset_m, kMm, 0.1, 60},
    {"normal_swallow", "wall_excursion_c2_mm", &R::normalWallC2_m, kMm, 0.2, 20},
    {"normal_swallow", "wall_excursion_c3_mm", &R::normalWallC3_m, kMm, 0.2, 20},
    {"normal_swallow", "wall_excursion_c4_mm", &R::normalWallC4_m, kMm, 0.2, 20},
    {"normal_swallow", "ues_diameter_mm", &R::normalUes_m, kMm, 1, 40},
    {"normal_swallow", "ues_volume_mL", &R::uesVolume_m3, kMl, 0.5, 50},
    {"normal_swallow", "ues_volume_exponent", &R::uesGrowth, kOne, 0, 1},
    {"normal_swallow", "ues_open_s", &R::normalUesOpen_s, kOne, 0.05, 5},

    {"gap_rule", "sealed_ratio", &R::sealedRatio, kOne, 0, 1, kBase},
    {"gap_rule", "sealed_mm", &R::sealed_m, kMm, 0, 5, "tongue_base_gap"},
    {"gap_rule", "trace_ratio", &R::traceRatio, kOne, 0, 1, kBase},
    {"gap_rule", "narrow_ratio", &R::narrowRatio, kOne, 0, 1, kBase},

    {"residue_rule", "trace_share", &R::residueTrace, kOne, 0, 1, kResidue},
    {"residue_rule", "pool_share", &R::residuePool, kOne, 0, 1, kResidue},
    {"residue_rule", "most_share", &R::residueMost, kOne, 0, 1, kResidue},
    {"residue_rule", "nearly_all_share", &R::residueNearlyAll, kOne, 0, 1, kResidue},
    {"residue_rule", "pool_thickness_mm", &R::poolThickness_m, kMm, 0.1, 10,
     "oral_residue_thickness,pharyngeal_residue_thickness"},
    {"residue_rule", "thickness_radius_mm", &R::thicknessRadius_m, kMm, 1, 15},
    {"residue_rule", "visible_chord_mm", &R::visibleChord_m, kMm, 0.05, 5},

    {"locations", "sulcus_u", &R::sulcusU, kOne, 0.3, 1},
    {"locations", "floor_end_mm", &R::floorEnd_m, kMm, 0, 40},
    {"locations", "vallecula_top_mm", &R::valleculaTop_m, kMm, 80, 150},
    {"locations", "vallecula_end_mm", &R::valleculaEnd_m, kMm, 80, 150},
    {"locations", "folds_end_mm", &R::foldsEnd_m, kMm, 100, 180},
    {"locations", "pyriform_top_mm", &R::pyriformTop_m, kMm, 100, 180},
    {"locations", "pyriform_end_mm", &R::pyriformEnd_m, kMm, 100, 180},
    {"locations", "pyriform_u", &R::pyriformU, kOne, 0.1, 1},

    {"airway", "least_particles", &R::leastParticles, kOne, 1, 100},
    {"airway", "folds_within_mm", &R::foldsWithin_m, kMm, 0, 10},

    {"component_2", "beside_share", &R::heldBeside, kOne, 0, 1, "held_beside"},
    {"component_2", "past_share", &R::heldPast, kOne, 0, 1, "held_past_ramus"},
    {"component_2", "most_past_share", &R::heldMostPast, kOne, 0, 1, "held_past_ramus"},

    {"component_4", "contact_gap_mm", &R::contactGap_m, kMm, 0.2, 5},
    {"component_4", "centroid_low_pass_hz", &R::lowPass_Hz, kOne, 1, 15},
    {"component_4", "centroid_until_share", &R::centroidUntilShare, kOne, 0.1, 1},
    {"component_4", "advance_speed_mm_per_s", &R::advanceSpeed_ms, kMm, 1, 200},
    {"component_4", "advance_path_mm", &R::advancePath_m, kMm, 1, 50},
    {"component_4", "advance_slack_mm", &R::advanceSlack_m, kMm, 0, 10},
    {"component_4", "slope_from_share", &R::slopeFrom, kOne, 0, 0.5},
    {"component_4", "slope_to_share", &R::slopeTo, kOne, 0.5, 1},
    {"component_4", "reversal_run_mm", &R::reversalRun_m, kMm, 0.5, 30},
    {"component_4", "reversal_run_no_bolus_mm", &R::dorsalRun_m, kMm, 0.5, 30},
    {"component_4", "accommodation_run_mm", &R::accommodationRun_m, kMm, 0, 30},
    {"component_4", "accommodation_time_s", &R::accommodationTime_s, kOne, 0, 3},
    {"component_4", "dorsal_least_rise_mm", &R::dorsalMinRise_m, kMm, 0.5, 15},
    {"component_4", "dorsal_tie_mm", &R::dorsalTie_m, kMm, 0, 5},
    {"component_4", "minimal_travel_mm", &R::minimalTravel_m, kMm, 1, 50,
     "contact_front_travel,dorsal_travel"},
    {"component_4", "minimal_wait_s", &R::minimalWait_s, kOne, 0.5, 30},
    {"component_4", "repetitive_reversals", &R::repetitiveReversals, kOne, 1, 20, "reversals"},
    {"component_4", "slow_mm_per_s", &R::slow_ms, kMm, 1, 500, "front_speed"},
    {"component_4", "brisk_mm_per_s", &R::brisk_ms, kMm, 1, 500, "front_speed"},
    {"component_4", "delayed_s", &R::delayed_s, kOne, 0.1, 20, "initial_delay"},

    {"component_6", "ramus_until_mm", &R::headOral_m, kMm, 60, 150, "bolus_head_at_hyb"},
    {"component_6", "vallecula_until_mm", &R::headVallecula_m, kMm, 80, 180, "bolus_head_at_hyb"},
    {"component_6", "rim_until_mm", &R::headRim_m, kMm, 90, 200, "bolus_head_at_hyb"},
    {"component_6", "wait_s", &R::initiationWait_s, kOne, 1, 30},

    {"component_7", "contrast_share", &R::nasalShare, kOne, 0, 1, "nasopharynx_most"},

    {"component_8", "epiglottis_horizontal_deg", &R::horizontal_rad, kDeg, 45, 135},
    {"component_8", "epiglottis_horizontal_within_deg", &R::horizontalWithin_rad, kDeg, 1, 45},
    {"component_8", "epiglottis_tie_deg", &R::epiglottisTie_rad, kDeg, 0, 20},
    {"component_8", "epiglottis_moves_deg", &R::epiglottisMoves_rad, kDeg, 1, 60},
    {"component_8", "after_hyoid_onset_s", &R::onsetAfter_s, kOne, 0, 1},
    {"component_8", "rise_full_ratio", &R::riseFull, kOne, 0, 2, kRise},
    {"component_8", "rise_half_ratio", &R::riseHalf, kOne, 0, 2, kRise},
    {"component_8", "rise_none_ratio", &R::riseNone, kOne, 0, 2, kRise},
    {"component_8", "vestibule_shut_ratio", &R::vestibuleShut, kOne, 0, 1, kGap},
    {"component_8", "vestibule_half_ratio", &R::vestibuleHalf, kOne, 0, 1, kGap},

    {"component_9", "full_ratio", &R::hyoidFull, kOne, 0, 2, "hyoid_anterior_ratio"},
    {"component_9", "none_ratio", &R::hyoidNone, kOne, 0, 2, "hyoid_anterior_ratio"},

    {"component_10", "inverted_deg", &R::inverted_rad, kDeg, 60, 180, "epiglottis_angle_max"},
    {"component_10", "turned_deg", &R::turned_rad, kDeg, 20, 120, "epiglottis_angle_max"},

    {"component_11", "narrow_ratio", &R::vestibuleNarrow, kOne, 0, 1, "vestibule_narrowest"},

    {"component_12", "wall_c2_mm", &R::wallC2_m, kMm, 80, 160},
    {"component_12", "wall_c3_mm", &R::wallC3_m, kMm, 80, 160},
    {"component_12", "wall_c4_mm", &R::wallC4_m, kMm, 80, 160},
    {"component_12", "full_ratio", &R::waveFull, kOne, 0, 2, kWave},
    {"component_12", "none_ratio", &R::waveNone, kOne, 0, 2, kWave},
    {"component_12", "slowest_mm_per_s", &R::waveSlowest_ms, kMm, 10, 1000, "wave_crest_speed"},
    {"component_12", "fastest_mm_per_s", &R::waveFastest_ms, kMm, 10, 2000, "wave_crest_speed"},

    {"component_13", "walls_top_mm", &R::wallTop_m, kMm, 60, 150},
    {"component_13", "walls_end_mm", &R::wallEnd_m, kMm, 100, 180},
    {"component_13", "best_height_mm", &R::bestHeight_m, kMm, 2, 60},
    {"component_13", "outline_smoothing_mm", &R::outlineSmooth_m, kMm, 5, 100},
    {"component_13", "pouch_height_mm", &R::pouchHeight_m, kMm, 2, 40},
    {"component_13", "bowing_ratio", &R::bowing, kOne, 0, 1, kBow},
    {"component_13", "asymmetry_ratio", &R::asymmetry, kOne, 0, 1, "side_wall_asymmetry"},
    {"component_13", "pouch_mm", &R::pouch_m, kMm, 0.2, 20, "pouch"},
    {"component_13", "residual_width_ratio", &R::residualWidth, kOne, 0, 1, "residual_width"},
    {"component_13", "shortening_least_ratio", &R::shorteningLeast, kOne, 0, 1, "shortening_ratio"},

    {"component_14", "diameter_full_ratio", &R::uesFull, kOne, 0, 2, "ues_diameter_ratio"},
    {"component_14", "diameter_narrow_ratio", &R::uesNarrow, kOne, 0, 2, "ues_diameter_ratio"},
    {"component_14", "diameter_none_ratio", &R::uesNone, kOne, 0, 2, "ues_diameter_ratio"},
    {"component_14", "open_long_ratio", &R::uesLong, kOne, 0, 2, "ues_open_ratio"},
    {"component_14", "open_brief_ratio", &R::uesBrief, kOne, 0, 2, "ues_open_ratio"},
    {"component_14", "held_some_share", &R::heldUpSome, kOne, 0, 1, "ues_held_up"},
    {"component_14", "held_much_share", &R::heldUpMuch, kOne, 0, 1, "ues_held_up"},
    {"component_14", "held_all_share", &R::heldUpAll, kOne, 0, 1, "ues_held_up"},

    {"component_15", "base_height_mm", &R::baseHeight_m, kMm, 4, 60},
    {"component_15", "most_retracted_within_mm", &R::baseTie_m, kMm, 0, 5},
    {"component_15", "base_moves_ratio", &R::baseMoves, kOne, 0, 1, "tongue_base_travel_ratio"},

    {"judging", "ambiguous_margin_share", &R::ambiguousMargin, kOne, 0, 0.9},
};
}  // namespace

bool RuleField::cuts(std::string_view quantity) const {
  if (!quantities) return false;
  for (std::string_view left = quantities; !left.empty();) {
    const std::size_t comma = left.find(',');
    if (left.substr(0, comma) == quantity) return true;
    left = comma == std::string_view::npos ? "" : left.substr(comma + 1);
  }
  return false;
}

std::span<const RuleField> ruleFields() {
  return kFields;
}
}  // namespace swallowclip::scoring
