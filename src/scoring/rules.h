// SPDX-License-Identifier: MIT
// Every cut that the measures use, in one plain struct, SI units, constructible without a file.
// "ref" = clinical-reference.md, its section; "assumed" = ours, with the range that is still sane.
#pragma once

namespace swallowclip::scoring {

struct ScoringRules {
  // Path stations (ref 0).
  double ramus_m = 0.072;       ///< mandibular ramus line
  double ridgeEnd_m = 0.015;    ///< contact must start within this; assumed, 0.008-0.020
  double uesTop_m = 0.150;      ///< upper end of the UES
  double uesEnd_m = 0.180;      ///< lower end of the UES, swallowed beyond
  double pharynxTop_m = 0.085;  ///< midline area for MPC; assumed, 0.080-0.090
  double pharynxEnd_m = 0.150;

  // Events (ref 1, 2, 3).
  double headShare = 0.02;       ///< bolus head: leading share of V0 (ref 3, comp. 2 and 6)
  double tailShare = 0.98;       ///< bolus tail: share of what passes at all; mirror of the head
  double throughShare = 0.5;     ///< least share of V0 that makes a transit; assumed 0.3-0.8
  double hyoidBurst_ms = 0.020;  ///< HYB (ref 3, comp. 6)
  double sealedRatio = 0.03;     ///< gap rule, sealed q (ref 3, shared rules)
  double sealed_m = 0.0003;      ///< gap rule, sealed g (ref 3, shared rules)
  double uesOpen_m = 0.0015;     ///< UES counts as open (ref 3, comp. 14)
  double restSpeed_ms = 0.005;   ///< SwRest; assumed, 0.003-0.010
  double restHold_s = 0.1;       ///< and for this long; assumed, 0.07-0.2

  // Component 4 (ref 3, comp. 4).
  double contactGap_m = 0.001;       ///< tongue counts as touching below this midline gap
  double lowPass_Hz = 6.0;           ///< oral centroid, zero phase
  double centroidUntilShare = 0.50;  ///< centroid used until this share has passed the ramus
  double advanceSpeed_ms = 0.020;    ///< a productive advance exceeds this ...
  double advancePath_m = 0.010;      ///< ... and covers this
  double advanceSlack_m = 0.002;     ///< backward step that ends an advance; assumed, 0.001-0.004
  double slopeFrom = 0.10, slopeTo = 0.90;
  double reversalRun_m = 0.004;       ///< shortest run of the centroid that counts
  double dorsalRun_m = 0.008;         ///< the same for the dorsal high point (no bolus)
  double accommodationRun_m = 0.006;  ///< runs below this ...
  double accommodationTime_s = 0.4;   ///< ... done within this after their start are dropped
  double dorsalMinRise_m = 0.0035;    ///< rise that makes a high point: more than the <=3 mm of
                                      ///< score 4's generator; assumed, 0.003-0.004
  double dorsalTie_m = 0.0005;     ///< stations this near the highest share it; assumed, 0.3-1 mm
  double minimalTravel_m = 0.010;  ///< score 4 below this
  double minimalWait_s = 6.0;      ///< judged this long after the last cue
  int repetitiveReversals = 2;     ///< score 3 from here on
  double slow_ms = 0.060;          ///< score 2 below this
  double brisk_ms = 0.080;         ///< between slow and brisk: ambiguous
  double delayed_s = 2.0;          ///< score 1 above this
  double ambiguousMargin = 0.15;   ///< nearer to a cut than this share of it: ambiguous
};
}  // namespace swallowclip::scoring
