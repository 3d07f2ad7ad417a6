"""OGRE's frame times, taken one at a time so that they can be interleaved with ours.

Runs under another Python than ours, one with ogre-python, trimesh and scipy. For each line on stdin it draws
one frame and prints its milliseconds: scene graph update, shadow pass, shading into a texture, glFinish.
Nothing is presented, and no display is needed where EGL can do without. Floor and boxes are one mesh each: a
thousand objects are slower in OGRE. What is not set here is at OGRE's defaults (uniform map, 2x2 filter).
"""

from __future__ import annotations

import argparse
import ctypes
import ctypes.util
import json
import os
import sys
import time
from pathlib import Path

import numpy as np
import Ogre
import trimesh
from Ogre import RTShader

BENCH = Path(__file__).parents[3] / "shared" / "bench"
TECHNIQUES = {
    "none": Ogre.SHADOWTYPE_NONE,
    "texture": Ogre.SHADOWTYPE_TEXTURE_ADDITIVE_INTEGRATED,
    "stencil additive": Ogre.SHADOWTYPE_STENCIL_ADDITIVE,
    "stencil modulative": Ogre.SHADOWTYPE_STENCIL_MODULATIVE,
}
GROUP = Ogre.RGN_DEFAULT
AUTOMATIC_WINDOW = FULL_SCREEN = False
# The first frames compile shaders.
WARM_UP = 3


class GeneratedShaders(Ogre.MaterialManager_Listener):
    """Gives every material shaders when it is first drawn; GL 3 has no fixed pipeline."""

    def __init__(self, generator: RTShader.ShaderGenerator) -> None:
        super().__init__()
        self.generator = generator

    def handleSchemeNotFound(  # noqa: N802  OGRE's name
        self, _index: int, scheme: str, material: Ogre.Material, _lod: int, _drawn: object
    ) -> Ogre.Technique | None:
        """The technique with shaders for `material`."""
        if scheme != Ogre.MSN_SHADERGEN:
            return None
        if not self.generator.createShaderBasedTechnique(material, Ogre.MSN_DEFAULT, scheme):
            return None
        self.generator.validateMaterial(scheme, material.getName(), material.getGroup())
        return next(one for one in material.getTechniques() if one.getSchemeName() == scheme)

    def afterIlluminationPassesCreated(self, technique: Ogre.Technique) -> bool:  # noqa: N802  OGRE's name
        """Give shaders to the passes that additive stencil shadows split a material into."""
        if technique.getSchemeName() != Ogre.MSN_SHADERGEN:
            return False
        material = technique.getParent()
        self.generator.validateMaterialIlluminationPasses(
            technique.getSchemeName(), material.getName(), material.getGroup()
        )
        return True


class OgreFrame:
    """One bench scene under one technique, drawn into a texture."""

    def __init__(self, scene: str, technique: str) -> None:
        self.setup = json.loads((BENCH / f"{scene}.json").read_text())
        self._start()
        self.manager = self.root.createSceneManager()
        self.stencil = "stencil" in technique
        self._generate_shaders()
        self._choose(technique)
        self._light()
        self._geometry(scene)
        self._camera()
        self.finish = ctypes.CDLL(ctypes.util.find_library("GL")).glFinish

    def draw(self) -> float:
        """Milliseconds of one whole frame."""
        self.finish()
        start = time.perf_counter()
        self.root.renderOneFrame()
        self.finish()
        return (time.perf_counter() - start) * 1e3

    def _start(self) -> None:
        # stdout carries the milliseconds: only what is about to end the program may be said there.
        os.environ["OGRE_MIN_LOGLEVEL"] = "4"
        self.root = Ogre.Root("", "", "")
        for plugin in ("RenderSystem_GL3Plus", "Codec_STBI"):
            self.root.loadPlugin(str(Path(Ogre.__file__).parent / "OGRE" / plugin))
        self.root.setRenderSystem(self.root.getAvailableRenderers()[0])
        self.root.initialise(AUTOMATIC_WINDOW)
        options = Ogre.NameValueMap()
        options["hidden"], options["vsync"] = "true", "false"
        self.window = self.root.createRenderWindow("context", 16, 16, FULL_SCREEN, options)
        self.window.setAutoUpdated(False)

    def _generate_shaders(self) -> None:
        media = next(Path(sys.prefix).glob("share/OGRE-*/Media"))
        groups = Ogre.ResourceGroupManager.getSingleton()
        for folder in ("Main", "RTShaderLib"):
            groups.addResourceLocation(str(media / folder), "FileSystem", Ogre.RGN_INTERNAL)
        RTShader.ShaderGenerator.initialize()
        self.generator = RTShader.ShaderGenerator.getSingleton()
        self.generator.addSceneManager(self.manager)
        self.listener = GeneratedShaders(self.generator)
        Ogre.MaterialManager.getSingleton().addListener(self.listener)
        groups.initialiseAllResourceGroups()

    def _choose(self, technique: str) -> None:
        if technique == "texture":
            side = self.setup["SM"]
            self.manager.setShadowTextureSettings(side, 1, Ogre.PF_DEPTH32)
            state = self.generator.getRenderState(Ogre.MSN_SHADERGEN)
            shadows = self.generator.createSubRenderState(RTShader.SRS_SHADOW_MAPPING)
            state.addTemplateSubRenderState(shadows)
        self.manager.setShadowTechnique(TECHNIQUES[technique])

    def _light(self) -> None:
        setup = self.setup
        self.manager.setAmbientLight(Ogre.ColourValue(*[setup["ambient"]] * 3))
        light = self.manager.createLight("light")
        light.setType(Ogre.Light.LT_SPOTLIGHT)
        # OGRE's cone angles are whole, the bench's are halves.
        inner, outer = (Ogre.Radian(np.radians(2 * setup[key])) for key in ("inner", "cutoff"))
        light.setSpotlightRange(inner, outer, 1.0)
        light.setAttenuation(setup["far"], 1.0, 0.0, 0.0)
        light.setShadowNearClipDistance(setup["lnear"])
        light.setShadowFarClipDistance(setup["lfar"])
        light.setCastShadows(True)
        self._place(setup["light"], setup["target"]).attachObject(light)

    def _geometry(self, scene: str) -> None:
        level = trimesh.load(BENCH / f"{scene}.glb", process=False)
        for node in level.graph.nodes_geometry:
            transform, name = level.graph[node]
            mesh = level.geometry[name].copy().apply_transform(transform)
            part = next(part for part in self.setup["col"] if part in node.lower())
            entity = self.manager.createEntity(self._mesh(node, mesh, self._material(part)))
            entity.setCastShadows(part != "floor")
            self.manager.getRootSceneNode().createChildSceneNode().attachObject(entity)

    def _material(self, part: str) -> Ogre.Material:
        material = Ogre.MaterialManager.getSingleton().create(part, GROUP)
        colour = Ogre.ColourValue(*self.setup["col"][part])
        material.setAmbient(colour)
        material.setDiffuse(colour)
        return material

    def _mesh(self, name: str, mesh: trimesh.Trimesh, material: Ogre.Material) -> Ogre.Mesh:
        built = self.manager.createManualObject(f"{name} as built")
        built.estimateVertexCount(len(mesh.vertices))
        built.estimateIndexCount(mesh.faces.size)
        built.begin(material, Ogre.RenderOperation.OT_TRIANGLE_LIST)
        for vertex, normal in zip(mesh.vertices.tolist(), mesh.vertex_normals.tolist(), strict=True):
            built.position(*vertex)
            built.normal(*normal)
        for triangle in mesh.faces.tolist():
            built.triangle(*triangle)
        built.end()
        converted = built.convertToMesh(name, GROUP)
        if self.stencil:
            converted.prepareForShadowVolume()
            converted.buildEdgeList()
        return converted

    def _camera(self) -> None:
        setup = self.setup
        camera = self.manager.createCamera("camera")
        camera.setNearClipDistance(setup["near"])
        camera.setFarClipDistance(setup["far"])
        camera.setFOVy(Ogre.Radian(np.radians(setup["fovy"])))
        camera.setAspectRatio(setup["W"] / setup["H"])
        self._place(setup["eye"], setup["look"]).attachObject(camera)
        textures = Ogre.TextureManager.getSingleton()
        self.texture = textures.createManual(
            "frame",
            GROUP,
            Ogre.TEX_TYPE_2D,
            setup["W"],
            setup["H"],
            0,
            Ogre.PF_BYTE_RGBA,
            Ogre.TU_RENDERTARGET,
        )
        self.target = self.texture.getBuffer().getRenderTarget()
        viewport = self.target.addViewport(camera)
        viewport.setMaterialScheme(Ogre.MSN_SHADERGEN)
        viewport.setOverlaysEnabled(False)
        self.target.setAutoUpdated(True)

    def _place(self, position: list[float], towards: list[float]) -> Ogre.SceneNode:
        node = self.manager.getRootSceneNode().createChildSceneNode(Ogre.Vector3(*position))
        node.setFixedYawAxis(True)
        node.lookAt(Ogre.Vector3(*towards), Ogre.Node.TS_WORLD)
        return node


def main() -> None:
    """Draw and time one frame for each line on stdin, or `--frames` at once."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", required=True)
    parser.add_argument("--technique", required=True, choices=TECHNIQUES)
    parser.add_argument("--frames", type=int, help="draw so many and stop, instead of reading stdin")
    parser.add_argument("--picture", type=Path, help="save the last frame here")
    arguments = parser.parse_args()
    frame = OgreFrame(arguments.scene, arguments.technique)
    for _ in range(WARM_UP):
        frame.draw()
    for _ in sys.stdin if arguments.frames is None else range(arguments.frames):
        sys.stdout.write(f"{frame.draw()}\n")
        sys.stdout.flush()
    if arguments.picture:
        frame.target.writeContentsToFile(str(arguments.picture))
    # OGRE's own end crashes under Python, after `shutdown` too.
    os._exit(0)


if __name__ == "__main__":
    main()
