!> Pairs whose deck does not say how they are enforced, at the nodes or surface to surface.
!>
!> At the nodes is what a pair is that says nothing. Where facets do not match it is carried out
!> surface to surface: pressures and forces are right then, at .4 to 1.9 times the time
!> (docs/which-method.md). So it is on the nonlinear path where facets match at the start: they
!> slide, nodes that come to joints of facets all at once find no equilibrium, and those of round
!> bodies leave the corners that they met for the chords beside them. Parts of a run with new
!> meshes stay at the nodes, one like the other.
module lopin_settle_formulation
   use lopin_error, only : error_type, log_type, severity
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type
   use lopin_contact_points, only : facing
   use lopin_element_type, only : cells_of_words
   use lopin_model, only : model_type, surface_of
   use lopin_mortar_pairs, only : shape_of
   use lopin_plan, only : plan_type, needs_nonlinear
   use lopin_scene, only : scene_type, meet_surfaces
   use lopin_surface, only : surface_type
   use lopin_text, only : to_text
   use lopin_surface_material, only : is_metal
   use lopin_uneven_pressure, only : unevenness, is_at_nodes, noticeable, all_of_it
   implicit none
   private
   public :: settle_formulation

contains

   !> What touches what at the start, as the pairs say or, where they leave it open, as is chosen.
   subroutine settle_formulation(scene, model, plan, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(inout) :: model
      type(plan_type), intent(inout) :: plan
      type(error_type), allocatable, intent(out) :: error
      type(log_type) :: said
      real(wp) :: uneven(size(model%pair))
      logical :: match(size(model%pair))
      integer :: i

      said = scene%log
      call meet_surfaces(scene, model, error)
      if (allocated(error)) return
      if (.not. any(model%pair%open .and. .not. model%pair%surface_to_surface)) return
      if (is_part(model)) return
      uneven = unevenness(scene, model, model%pair%open)
      match = uneven < 0.0_wp
      if (needs_nonlinear(model)) then
         where (match .and. [(model%pair(i)%open .and. is_at_nodes(model, model%pair(i)), &
            & i=1, size(match))]) uneven = 0.0_wp
      end if
      if (model%mesh%ndim == 3 .or. needs_nonlinear(model)) then
         where (hangs_over(scene, model)) uneven = -1.0_wp
      end if
      if (.not. any(uneven >= 0.0_wp)) return
      scene%log = said
      call integrate(scene, model, uneven, match)
      plan%reason = plan%reason//'; surface to surface where facets do not match'
      if (any(match .and. uneven >= 0.0_wp)) plan%reason = plan%reason//', or slide'
      call meet_surfaces(scene, model, error)
   end subroutine settle_formulation

   !> The mesh is made anew on the way, or was: the next one may match.
   pure logical function is_part(model)
      type(model_type), intent(in) :: model

      is_part = model%remeshes
      if (allocated(model%initial_state)) is_part = is_part .or. size(model%initial_state) > 0
      if (allocated(model%initial_traction)) is_part = is_part &
         & .or. size(model%initial_traction) > 0
   end function is_part

   !> An elastic slave hangs over its master: a facet that faces it has a node that has nothing
   !> opposite beside one that has. Where the master ends within its facets, as a leaf of a spring
   !> does, the line of contact is narrower than these, and their means stand for more of it than
   !> the nodes do. Metal bears evenly there. What looks away, as the other sides of a skin, hangs
   !> over nothing.
   function hangs_over(scene, model) result(hangs)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      logical :: hangs(size(model%pair))
      integer :: i

      do i = 1, size(hangs)
         associate (first => scene%points%first(i), last => scene%points%first(i + 1) - 1)
            hangs(i) = any(scene%points%facet(first:last) == 0) &
               & .and. .not. is_metal(model, model%pair(i)%slave)
         end associate
         if (hangs(i) .and. model%surface(model%pair(i)%slave)%kind == surface_of%faces) &
            & hangs(i) = a_facet_hangs(scene, model, i)
      end do
   end function hangs_over

   !> The same, of a slave of faces.
   logical function a_facet_hangs(scene, model, pair) result(hangs)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(surface_type) :: slave
      type(cell_type), allocatable :: cells(:)
      type(error_type), allocatable :: error
      integer :: of(model%mesh%nnode), f, i, k
      logical :: misses, faces

      hangs = .true.
      call cells_of_words(model%element_word, cells)
      call shape_of(slave, model, cells, model%pair(pair)%slave, error)
      if (allocated(error)) return
      of = 0
      associate (points => scene%points)
         do i = points%first(pair), points%first(pair + 1) - 1
            of(points%node(i)) = i
         end do
         do f = 1, slave%facets%n
            misses = .false.
            faces = .false.
            do k = 1, slave%facets%nnode(f)
               i = of(slave%facets%node(k, f))
               if (i == 0) cycle
               if (points%facet(i) == 0) misses = .true.
               if (points%facet(i) /= 0) faces = faces .or. dot_product(slave%disc(4:6, f), &
                  & points%normal(:, i)) < facing
            end do
            if (misses .and. faces) return
         end do
      end associate
      hangs = .false.
   end function a_facet_hangs

   !> Take pairs surface to surface, and say so: all whose facets do not match, or may not once they
   !> have slid. Where the pressure of the slave would be even, the master would still have it at
   !> the nodes of the slave alone.
   subroutine integrate(scene, model, uneven, match)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(inout) :: model
      real(wp), intent(in) :: uneven(:)            !! (pairs)
      logical, intent(in) :: match(:)              !! (pairs) facets do, at the start
      character(len=:), allocatable :: how
      integer :: pair

      do pair = 1, size(model%pair)
         if (uneven(pair) < 0.0_wp) cycle
         associate (p => model%pair(pair))
            p%surface_to_surface = .true.
            how = 'facets that do not match would press the other side at single nodes'
            if (uneven(pair) > noticeable) how = 'facets that do not match would make the '// &
               & 'pressure at its nodes uneven by about '// &
               & to_text(100.0_wp*min(uneven(pair), all_of_it), 2)//' %'
            if (match(pair)) how = 'facets that slide do not match for long'
            call scene%log%say(severity%note, 'N0347', 'pair ('//model%surface(p%slave)%name// &
               & ', '//model%surface(p%master)%name//'): '//how// &
               & ': carried out surface to surface', p%at, &
               & help='TYPE=NODE TO SURFACE where contact at the nodes is meant')
         end associate
      end do
   end subroutine integrate
end module lopin_settle_formulation
