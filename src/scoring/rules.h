// SPDX-License-Identifier: MIT
// Every number that the measures and scores use, SI units. The numbers stand in one data file,
// scenes/scoring_rules.json, with their sources, so that a clinician can review and change them;
// here are only their names. scene/rules_file.h reads it, this table checks it.
#pragma once
#include <span>
#include <string_view>

namespace swallowclip::scoring {

struct ScoringRules {
  // Stations along the bolus path.
  double ramus_m = 0, ridgeEnd_m = 0, uesTop_m = 0, uesEnd_m = 0, pharynxTop_m = 0,
         pharynxEnd_m = 0;
  // Events.
  double headShare = 0, tailShare = 0, throughShare = 0, hyoidBurst_ms = 0, uesOpen_m = 0;
  double restSpeed_ms = 0, restHold_s = 0, residueSpeed_ms = 0;
  // The normal swallow of the default scene, which ratios refer to.
  double normalHyoidAnterior_m = 0, normalTongueBase_m = 0, normalShortening_m = 0;
  double normalRiseHorizontal_m = 0, normalRiseInverted_m = 0, normalRiseOnset_m = 0;
  double normalWallC2_m = 0, normalWallC3_m = 0, normalWallC4_m = 0;
  double normalUes_m = 0, normalUesOpen_s = 0, uesVolume_m3 = 0, uesGrowth = 0;
  // Gap rule, shared.
  double sealedRatio = 0, sealed_m = 0, traceRatio = 0, narrowRatio = 0;
  // Residue rule, shared.
  double residueTrace = 0, residuePool = 0, residueMost = 0, residueNearlyAll = 0;
  double poolThickness_m = 0, thicknessRadius_m = 0, visibleChord_m = 0;
  // Where residue lies.
  double sulcusU = 0, floorEnd_m = 0, valleculaTop_m = 0, valleculaEnd_m = 0, foldsEnd_m = 0;
  double pyriformTop_m = 0, pyriformEnd_m = 0, pyriformU = 0;
  // Airway.
  double leastParticles = 0, foldsWithin_m = 0;
  // Component 2.
  double heldBeside = 0, heldPast = 0, heldMostPast = 0;
  // Component 4.
  double contactGap_m = 0, lowPass_Hz = 0, centroidUntilShare = 0, advanceSpeed_ms = 0;
  double advancePath_m = 0, advanceSlack_m = 0, slopeFrom = 0, slopeTo = 0, reversalRun_m = 0;
  double dorsalRun_m = 0, accommodationRun_m = 0, accommodationTime_s = 0, dorsalMinRise_m = 0;
  double dorsalTie_m = 0, minimalTravel_m = 0, minimalWait_s = 0, repetitiveReversals = 0;
  double slow_ms = 0, brisk_ms = 0, delayed_s = 0;
  // Component 6.
  double headOral_m = 0, headVallecula_m = 0, headRim_m = 0, initiationWait_s = 0;
  // Component 7.
  double nasalShare = 0;
  // Component 8.
  double horizontal_rad = 0, epiglottisMoves_rad = 0, horizontalWithin_rad = 0;
  double epiglottisTie_rad = 0, onsetAfter_s = 0;
  double riseFull = 0, riseHalf = 0, riseNone = 0, vestibuleShut = 0, vestibuleHalf = 0;
  // Components 9, 10, 11.
  double hyoidFull = 0, hyoidNone = 0, inverted_rad = 0, turned_rad = 0, vestibuleNarrow = 0;
  // Component 12.
  double waveFull = 0, waveNone = 0, waveSlowest_ms = 0, waveFastest_ms = 0;
  double wallC2_m = 0, wallC3_m = 0, wallC4_m = 0;
  // Component 13.
  double wallTop_m = 0, wallEnd_m = 0, bestHeight_m = 0, outlineSmooth_m = 0, pouchHeight_m = 0;
  double bowing = 0, asymmetry = 0, pouch_m = 0, residualWidth = 0, shorteningLeast = 0;
  // Component 14.
  double uesFull = 0, uesNarrow = 0, uesNone = 0, uesLong = 0, uesBrief = 0;
  double heldUpSome = 0, heldUpMuch = 0, heldUpAll = 0;
  // Component 15.
  double baseHeight_m = 0, baseTie_m = 0, baseMoves = 0;
  /// A deciding quantity nearer to a cut than this share of the cut is ambiguous.
  double ambiguousMargin = 0;
};

/// One number of the file.
struct RuleField {
  const char* section;
  const char* key;
  double ScoringRules::*member;
  double scale;     ///< SI value = number in the file * scale
  double min, max;  ///< plausible numbers in the file
  /// Names of the quantities that it cuts between two scores (with commas); nullptr: no cut.
  const char* quantities = nullptr;

  /// Whether it is a cut of this quantity.
  bool cuts(std::string_view quantity) const;
};

/// All of them, in the order of the file.
std::span<const RuleField> ruleFields();
}  // namespace swallowclip::scoring
