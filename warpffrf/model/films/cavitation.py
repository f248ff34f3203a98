"""What becomes of a film where its pressure would fall below that of cavitation, which is zero here."""

from __future__ import annotations

CAVITATIONS = {
    "jfo": "film or void, and the oil that enters a cavity comes out of it: p >= 0, void D >= 0, p D = 0",
    "reynolds": "the film ends where pressure and slope vanish; oil is lost where it ends and found where it begins",
    "full_sommerfeld": "pressures of any sign, a film that never breaks",
    "half_sommerfeld": "as 'full_sommerfeld', and negative pressures are left out of the forces",
}
