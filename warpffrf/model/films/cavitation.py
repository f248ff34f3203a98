"""What becomes of a film where its pressure would fall below that of cavitation, which is zero here."""

from __future__ import annotations

CAVITATIONS = {
    "mass_conserving": "film or void, and the oil that enters a cavity comes out of it: p >= 0, void D >= 0, p D = 0",
    "reynolds": "the film ends where pressure and slope vanish; oil is lost where it ends and found where it begins",
    "none": "pressures of any sign, a film that never breaks",
    "half": "as 'none', and negative pressures are left out of the forces",
}
