# Draws what scenario.json lists, as a program of Godot.
extends Node3D

var camera := Camera3D.new()
var sun := DirectionalLight3D.new()
var environment := Environment.new()

func _ready():
	print("renderer ", RenderingServer.get_current_rendering_method())
	environment.background_mode = Environment.BG_COLOR
	environment.ambient_light_source = Environment.AMBIENT_SOURCE_DISABLED
	environment.tonemap_mode = Environment.TONE_MAPPER_LINEAR
	var world := WorldEnvironment.new()
	world.environment = environment
	add_child(world)
	add_child(camera)
	add_child(sun)
	camera.current = true
	var scenario = JSON.parse_string(FileAccess.get_file_as_string("res://scenario.json"))
	for shot in scenario:
		await draw(shot)
	print("drawn ", scenario.size())
	get_tree().quit()

func vector(numbers) -> Vector3:
	return Vector3(numbers[0], numbers[1], numbers[2])

func draw(shot):
	camera.position = vector(shot.camera)
	camera.look_at(vector(shot.target))
	camera.fov = shot.fov
	environment.background_color = Color(shot.background, shot.background, shot.background)
	sun.visible = shot.has("to_light")
	if sun.visible:
		sun.look_at_from_position(Vector3.ZERO, -vector(shot.to_light), Vector3(0.1, 0.9, 0.3))
		sun.light_energy = shot.energy
	var scene = load("res://%s/haze_particles.tscn" % shot.folder).instantiate()
	var particles: GPUParticles3D = scene.get_child(0)
	var material: ShaderMaterial = particles.draw_pass_1.material
	material = material.duplicate()
	for name in shot.parameters:
		var value = shot.parameters[name]
		if value is String:
			value = ImageTexture.create_from_image(Image.load_from_file(value))
		elif value is Array:
			value = Vector2(value[0], value[1])
		material.set_shader_parameter(name, value)
	if shot.has("alpha"):
		var shader := Shader.new()
		var pattern := RegEx.create_from_string("ALPHA = .*;")
		shader.code = pattern.sub(material.shader.code, "ALPHA = %s;" % shot.alpha)
		material.shader = shader
	var shown: Node3D = scene
	if shot.kind == "quad":
		scene.free()
		shown = MeshInstance3D.new()
		shown.mesh = QuadMesh.new()
		shown.mesh.size = Vector2(2, 2)
		shown.mesh.material = material
	elif shot.kind == "known particles":
		# Places and INSTANCE_CUSTOM of particles, by a process shader of the test.
		var process := ShaderMaterial.new()
		process.shader = Shader.new()
		process.shader.code = shot.process
		particles.process_material = process
		particles.amount = int(shot.amount)
		particles.transform = Transform3D()
		particles.lifetime = 100.0
		particles.preprocess = 0.0
		particles.one_shot = false
		particles.explosiveness = 1.0
		particles.draw_pass_1 = particles.draw_pass_1.duplicate()
		particles.draw_pass_1.center_offset = Vector3.ZERO
		particles.draw_pass_1.material = material
	else:
		particles.draw_pass_1.material = material
	add_child(shown)
	for index in shot.files.size():
		for frame in int(shot.frames):
			await RenderingServer.frame_post_draw
		get_viewport().get_texture().get_image().save_png(shot.files[index])
		if shot.kind == "scene" and index == shot.files.size() - 1:
			var box := particles.capture_aabb()
			print("box ", JSON.stringify({ "folder": shot.folder, "min": [box.position.x, box.position.y, box.position.z],
				"max": [box.end.x, box.end.y, box.end.z] }))
	shown.queue_free()
	await get_tree().process_frame
