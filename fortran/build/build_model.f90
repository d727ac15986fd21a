!> From the blocks of a deck to the model: every name resolved, every value checked.
!>
!> Names may be used before they are defined: each part first collects, then resolves. Errors are
!> collected and raised together; where an error would make others follow from it, building
!> stops early.
module lopin_build_model
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, location_type, severity, raise_all
   use lopin_text, only : to_text, parse_real, parse_integer
   use lopin_model, only : model_type
   use lopin_block, only : deck_type, complain
   use lopin_build_scene, only : scene_type, get_word
   use lopin_build_settings, only : build_settings
   use lopin_keywords, only : new_keyword_table
   use lopin_keyword_table, only : keyword_table_type
   use lopin_build_parts, only : new_scene
   use lopin_build_states, only : build_tractions
   use lopin_build_heat, only : build_initial_conditions, build_temperatures
   use lopin_build_mesh, only : build_mesh
   use lopin_build_sets, only : build_sets
   use lopin_build_materials, only : build_materials
   use lopin_build_sections, only : build_sections, check_sections
   use lopin_build_surfaces, only : build_surfaces
   use lopin_build_pretension, only : cut_type, cut_sections, join_sections
   use lopin_build_constraints, only : build_rigid_bodies, build_equations
   use lopin_build_transforms, only : build_transforms
   use lopin_build_interactions, only : build_interactions
   use lopin_build_contact, only : build_pairs
   use lopin_build_ties, only : build_ties
   use lopin_build_amplitudes, only : build_amplitudes
   use lopin_build_steps, only : build_steps
   use lopin_build_behaviours, only : build_behaviour_changes
   use lopin_build_flat_surfaces, only : find_flat_surfaces
   use lopin_build_springs, only : build_springs
   use lopin_build_changes, only : build_changes
   use lopin_build_start, only : build_start
   use lopin_settle_flow, only : settle_flow
   use lopin_settle_friction, only : settle_friction
   use lopin_settle_layers, only : settle_layers
   use lopin_check_rigid_pairs, only : check_rigid_pairs
   use lopin_node_areas, only : find_node_areas
   use lopin_check_loads, only : check_loads
   use lopin_check_materials, only : check_materials
   use lopin_check_seams, only : check_seams
   use lopin_check_hanging, only : check_hanging
   use lopin_check_unused, only : check_unused
   use lopin_check_options, only : check_options
   use lopin_advise, only : advise
   implicit none
   private
   public :: new_model

contains

   !> Build and check the model; notes and warnings are left in `model%log`.
   subroutine new_model(model, deck, error)
      type(model_type), intent(out) :: model
      type(deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      type(scene_type) :: scene
      type(cut_type), allocatable :: cuts(:)
      type(keyword_table_type) :: table
      logical, allocatable :: rigid(:), absolute(:)

      call read_general(model, deck)
      call new_keyword_table(table)
      call build_settings(model%settings, deck, table)
      call new_scene(scene, deck, model%log)
      call build_mesh(model, deck, scene)
      if (model%log%count_of(severity%error) == 0 &
         & .and. model%mesh%nnode == 0) call complain(model%log, 'E0202', &
         & 'the deck has no nodes', location_type(1, 1, 1, 1), &
         & help='give them by *NODE, or the file that has them by *INCLUDE, INPUT=')
      call raise_all(error, error_code%deck, model%log)
      if (allocated(error)) return

      call build_sets(model, deck, scene)
      call build_materials(model, deck, scene)
      call build_sections(model, deck, scene)
      call build_surfaces(model, deck, scene)
      call find_flat_surfaces(model)
      call cut_sections(cuts, model, deck, scene)
      allocate (rigid(model%mesh%nelement))
      call build_rigid_bodies(model, deck, scene, rigid)
      if (model%log%count_of(severity%error) == 0) call check_sections(model, scene, rigid)
      call build_initial_conditions(model, deck, scene)
      call build_equations(model, deck, scene)
      call build_transforms(model, deck, scene)
      call build_springs(model, deck, scene)
      call build_interactions(model, deck, scene)
      call build_pairs(model, deck, scene)
      call build_tractions(model, deck, scene)
      call build_ties(model, deck, scene)
      call build_amplitudes(model, deck, scene, absolute)
      call build_steps(model, deck, scene, absolute)
      call build_temperatures(model, deck, scene)
      call join_sections(cuts, model)
      call build_behaviour_changes(model, deck, scene)
      call build_changes(model, deck, scene)
      call build_start(model, deck, scene)
      if (model%log%count_of(severity%error) == 0) call settle_flow(model)
      if (model%log%count_of(severity%error) == 0) call settle_friction(model)
      if (model%log%count_of(severity%error) == 0) call check_rigid_pairs(model)
      if (model%log%count_of(severity%error) == 0) call check_whole(model, deck, scene)
      call raise_all(error, error_code%deck, model%log)
   end subroutine new_model

   !> What can be told once every card has been read, and advice.
   subroutine check_whole(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(inout) :: scene

      call check_materials(model)
      call find_node_areas(model)
      call check_loads(model)
      call check_seams(model)
      call check_hanging(model, scene)
      call check_unused(model, deck)
      call check_options(model, deck)
      call settle_layers(model)
      call advise(model)
   end subroutine check_whole

   !> `*HEADING` and `*LOPIN`.
   subroutine read_general(model, deck)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: k, j
      logical :: found

      model%heading = ''
      model%path = 'AUTO'
      model%solver = 'AUTO'
      do k = 1, deck%nblock
         associate (block => deck%block(k))
            if (block%keyword == 'HEADING') then
               do j = 1, block%nline
                  if (len(model%heading) > 0) model%heading = model%heading//' '
                  model%heading = model%heading//trim(adjustl(block%line(j)%text))
               end do
            end if
            if (block%keyword /= 'LOPIN') cycle
            call get_word(block, 'PATH', word, at, found)
            if (found) model%path = word
            if (found) model%path_at = at
            call get_word(block, 'SOLVER', word, at, found)
            if (found) model%solver = word
            call get_word(block, 'TARGET ERROR', word, at, found)
            if (found) call parse_real(word, model%target_error, found)
            if (found .and. .not. (model%target_error > 0.0_wp &
               & .and. model%target_error < 1.0_wp)) call &
               & complain(model%log, 'E0408', 'TARGET ERROR='//word//' is not between 0 and 1', at)
            call get_word(block, 'QUANTITY', word, at, found)
            if (found) call model%log%say(severity%warning, 'W0344', 'QUANTITY='//word// &
               & ': this is one run on the mesh of the deck, its error is not estimated', at, &
               & help='run the deck by the command of the Python package: it refines until '// &
               & 'TARGET ERROR is met')
            call get_word(block, 'CONTINUATION', word, at, found)
            if (found) call parse_integer(word, model%continuation, found)
            if (found .and. model%continuation < 1) call complain(model%log, 'E0408', &
               & 'CONTINUATION='//word &
               & //' is less than 1', at)
            call get_word(block, 'MORTAR DEGREE', word, at, found)
            if (found) call parse_integer(word, model%mortar_degree, found)
            if (found .and. (model%mortar_degree < 5 .or. model%mortar_degree > 40)) call &
               & complain(model%log, 'E0408', 'MORTAR DEGREE='//word//' is not 5 to 40', at)
         end associate
      end do
   end subroutine read_general
end module lopin_build_model
