"""What an IPE 300 of S235 carries in bending: M_max = fy W_pl = fy ∫ |y - y_pc| dA."""

from capacity import capacity, parse_material, parse_section


def main() -> float:
    """Plastic moment [kN m]."""
    result = capacity(parse_section("IPE 300"), parse_material("S235"))
    return 1e-3 * result.M_max


if __name__ == "__main__":
    print(f"M_max = {main():.1f} kN m")
