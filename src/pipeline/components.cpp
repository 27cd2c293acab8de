// SPDX-License-Identifier: MIT
#include "pipeline/components.h"

namespace swallowclip::pipeline {
namespace {
using Text = const char* const;
Text kLips[] = {"Lips hold everything in", "A little between the lips, none outside",
                "Some reaches the red of the lip", "Leaks below the lip, above mid-chin",
                "Runs down past mid-chin"};
Text kHold[] = {"Held together between tongue and palate", "Spills sideways or under the tongue",
                "Part of it slips back behind the tongue",
                "Most of it slips back behind the tongue"};
Text kChewing[] = {"Chewed and gathered without delay", "Chewed long, then gathered",
                   "Gathered badly, some left unchewed", "Hardly chewed, most left in lumps"};
Text kTransport[] = {"One brisk sweep from tip to base", "Long wait, then a brisk sweep",
                     "Slow one-way sweep", "Back-and-forth tongue motion before it leaves",
                     "Almost no tongue motion"};
Text kOralResidue[] = {"Mouth empty", "A thin coating stays in the mouth",
                       "A pool stays in the mouth", "Most of it stays in the mouth",
                       "Nearly all of it stays in the mouth"};
Text kInitiation[] = {"Hyoid starts with the bolus at the jaw angle",
                      "Hyoid starts with the bolus in the valleculae",
                      "Hyoid starts with the bolus behind the epiglottis",
                      "Hyoid starts with the bolus in the pyriform sinuses", "Hyoid never starts"};
Text kVelum[] = {"Velum shuts off the nose", "A thin gap behind the velum",
                 "Some rises behind the velum", "Some enters the nasal cavity",
                 "Some reaches the nostrils"};
Text kLarynx[] = {"Larynx rises fully", "Larynx rises most of the way", "Larynx rises a little",
                  "Larynx does not rise"};
Text kHyoid[] = {"Hyoid moves fully forward", "Hyoid moves partly forward",
                 "Hyoid does not move forward"};
Text kEpiglottis[] = {"Epiglottis turns right over", "Epiglottis stops about level",
                      "Epiglottis stays up"};
Text kVestibule[] = {"Entrance of the airway shut", "A narrow column stays in the entrance",
                     "Entrance of the airway stays wide"};
Text kStripping[] = {"Wave runs down the whole back wall", "Weak or broken wave on the back wall",
                     "No wave on the back wall"};
Text kContraction[] = {"Both side walls close in evenly", "Small pouches at the sides",
                       "One side wall bows outward", "Both side walls bow outward"};
Text kPes[] = {"Opens wide and long enough, flow unhindered",
               "Opens less or shorter, flow a little hindered", "Opens barely, most is held up",
               "Does not open, nothing passes"};
Text kTongueBase[] = {"Tongue base meets the back wall", "A hairline stays between them",
                      "A narrow gap stays between them", "A wide gap stays between them",
                      "Tongue base hardly moves back"};
Text kPharynxResidue[] = {"Throat empty", "A thin coating stays in the throat",
                          "A pool stays in the throat", "Most of it stays in the throat",
                          "Nearly all of it stays in the throat"};
Text kEsophagus[] = {"Esophagus clears", "Some stays in the esophagus",
                     "Some moves back up within the esophagus",
                     "Some comes back up into the throat", "Little or none clears"};

const Component kComponents[] = {
    {1, "lip-closure", "Lip closure", kLips},
    {2, "tongue-control", "Tongue control while holding", kHold},
    {3, "preparation", "Chewing and preparation", kChewing},
    {4, "bolus-transport", "Bolus transport by the tongue", kTransport},
    {5, "oral-residue", "Oral residue", kOralResidue},
    {6, "initiation", "Initiation of the pharyngeal swallow", kInitiation},
    {7, "soft-palate", "Soft palate elevation", kVelum},
    {8, "laryngeal-elevation", "Laryngeal elevation", kLarynx},
    {9, "hyoid-excursion", "Anterior hyoid excursion", kHyoid},
    {10, "epiglottis", "Epiglottic movement", kEpiglottis},
    {11, "laryngeal-closure", "Laryngeal vestibular closure", kVestibule},
    {12, "stripping-wave", "Pharyngeal stripping wave", kStripping},
    {13, "pharyngeal-contraction", "Pharyngeal contraction", kContraction},
    {14, "pes-opening", "Pharyngoesophageal segment opening", kPes},
    {15, "tongue-base", "Tongue base retraction", kTongueBase},
    {16, "pharyngeal-residue", "Pharyngeal residue", kPharynxResidue},
    {17, "esophageal-clearance", "Esophageal clearance", kEsophagus},
};
}  // namespace

std::span<const Component> components() {
  return kComponents;
}

const Component* findComponent(int number) {
  return number >= 1 && number <= 17 ? &kComponents[number - 1] : nullptr;
}
}  // namespace swallowclip::pipeline
