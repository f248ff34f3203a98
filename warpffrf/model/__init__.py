"""What a user describes: material, mesh, surfaces, scene, joints, forces, contact. Pure data, no Warp."""
