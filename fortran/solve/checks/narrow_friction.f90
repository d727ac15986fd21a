!> Friction that goes by area where contact is narrower than the facets that touch.
!>
!> A shear that the flow stress bounds (TRESCA, CRISTESCU, TAUMAX, NORTON-HOFF) acts on the area of
!> nodes that press. Where a sheet slides over a radius it touches along a line: one node has the
!> area of a facet, and the friction of ten such lines. Of n nodes side by side the area is known
!> but for a facet: the work of the nodes at the rim of contact, by the share of their facets that
!> touches in part, beside all other work, is about what the force may be too large by.
module lopin_narrow_friction
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_vectors, only : cross
   use lopin_stream, only : stream_type
   use lopin_friction, only : has_friction, jumps_at_touch, friction_radius
   use lopin_model, only : model_type
   use lopin_slip_increment, only : condition_at, dissipated
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: narrow_friction_type, measure_narrow_friction, tell_narrow_friction

   !> Of other work; of the bound that does not follow the pressure.
   real(wp), parameter :: told = 0.05_wp, rounding = 1.0e-3_wp

   !> Work so far by pair.
   type :: narrow_friction_type
      real(wp), allocatable :: work(:)         !! (npair) [energy]
   contains
      procedure :: keep => keep_narrow
   end type narrow_friction_type

contains

   !> To a stream or back.
   subroutine keep_narrow(self, stream)
      class(narrow_friction_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%work)
   end subroutine keep_narrow

   !> Look at an accepted increment.
   subroutine measure_narrow_friction(self, scene, model)
      type(narrow_friction_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), allocatable :: work(:), partly(:)
      integer :: pair, i

      if (.not. scene%newton%in_use) return
      if (.not. allocated(self%work)) allocate (self%work(size(model%pair)), source=0.0_wp)
      associate (c => scene%newton%contact)
         allocate (work(c%n), source=0.0_wp)
         do i = 1, c%n
            work(i) = by_area(scene, i)
         end do
         do pair = 1, size(model%pair)
            if (.not. any(work > 0.0_wp .and. c%pair(:c%n) == pair)) cycle
            call find_partly(scene, model, pair, partly)
            do i = 1, c%n
               if (c%pair(i) == pair) self%work(pair) = self%work(pair) + work(i)*partly(c%node(i))
            end do
         end do
      end associate
   end subroutine measure_narrow_friction

   !> Work of friction of a point in the increment, as far as its bound goes by area [energy].
   pure real(wp) function by_area(scene, i) result(work)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: i
      real(wp) :: bound, slope, followed       !! share of the bound that follows the pressure [-]

      work = 0.0_wp
      associate (c => scene%newton%contact)
         if (c%facet(i) == 0 .or. c%enforcement(i)%tied .or. c%status(i) <= 0) return
         if (.not. has_friction(c%friction(c%pair(i)))) return
         call friction_radius(c%friction(c%pair(i)), c%pressure(i), condition_at(c, i), bound, &
            & slope)
         if (.not. (bound > 0.0_wp .and. bound < huge(1.0_wp))) return
         followed = slope*c%pressure(i)/bound
         ! A bound that still rises from nothing is steeper than any metal that touches in full.
         if (jumps_at_touch(c%friction(c%pair(i))) .and. followed > 1.0_wp - rounding) &
            & followed = 0.0_wp
         if (followed > 1.0_wp - rounding) return
         work = max(0.0_wp, dissipated(c, i)*c%weight(i)*(1.0_wp - followed))
      end associate
   end function by_area

   !> Share of the facets around each node of the slave that touch with some of their nodes alone;
   !> those that face elsewhere, as the side of a billet beside its top, have no part in it.
   subroutine find_partly(scene, model, pair, partly)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), allocatable, intent(out) :: partly(:)   !! (nnode) [-]
      logical :: closed(model%mesh%nnode)
      real(wp) :: normal(3, model%mesh%nnode)
      integer :: all_around(model%mesh%nnode), i

      allocate (partly(model%mesh%nnode), source=0.0_wp)
      associate (c => scene%newton%contact, own => scene%newton%contact%masters%of(pair))
         if (.not. own%has_slave_faces) return
         closed = .false.
         normal = 0.0_wp
         do i = 1, c%n
            if (c%pair(i) /= pair .or. c%status(i) <= 0) cycle
            closed(c%node(i)) = .true.
            normal(:, c%node(i)) = c%normal(:, i)
         end do
         all_around = 0
         do i = 1, own%slave%n
            associate (nodes => own%slave%node(:own%slave%nnode(i), i))
               if (.not. is_opposite(c%masters%x(:, nodes), normal(:, nodes))) cycle
               all_around(nodes) = all_around(nodes) + 1
               if (.not. all(closed(nodes))) partly(nodes) = partly(nodes) + 1.0_wp
            end associate
         end do
         partly = partly/max(1, all_around)
      end associate
   end subroutine find_partly

   !> A facet that faces the master within 60 degrees at one of its nodes that touch.
   pure logical function is_opposite(x, normal)
      real(wp), intent(in) :: x(:, :)          !! (ndim, nodes) corners first [length]
      real(wp), intent(in) :: normal(:, :)     !! (3, nodes) out of the master; 0: does not touch
      real(wp) :: own(3)
      integer :: i

      if (size(x, 1) == 2) then
         own = [x(2, 2) - x(2, 1), x(1, 1) - x(1, 2), 0.0_wp]
      else
         own = cross(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1))
      end if
      is_opposite = any([(dot_product(own, normal(:, i)) < -0.5_wp*norm2(own), i=1, size(x, 2))])
   end function is_opposite

   !> At the end of a step.
   subroutine tell_narrow_friction(self, scene, model, whole)
      type(narrow_friction_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: whole            !! work done so far [energy]
      real(wp) :: share
      integer :: pair

      if (.not. allocated(self%work)) return
      do pair = 1, size(model%pair)
         if (.not. self%work(pair) > told*(whole - self%work(pair))) cycle
         share = self%work(pair)/max(whole - self%work(pair), told*whole)
         associate (p => model%pair(pair))
            call warn_once(scene%log, 'W0560', 'friction of pair ('// &
               & model%surface(p%slave)%name//', '//model%surface(p%master)%name// &
               & ') is bounded by the metal and acts on whole facets where less of them '// &
               & 'touches: such work is '//to_text(100.0_wp*share, 2)// &
               & ' % of all other by the end of step '//to_text(scene%step)// &
               & ', and the force may be too large by as much', p%at, &
               & help='finer facets of the slave where it slides over radii, or COULOMB or '// &
               & 'COULOMB-OROWAN, whose friction follows the force')
         end associate
      end do
   end subroutine tell_narrow_friction
end module lopin_narrow_friction
