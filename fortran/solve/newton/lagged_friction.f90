!> Quantities that friction takes from the last Newton iteration on the nonlinear path: stress and
!> speed.
!>
!> Cristescu's law reads the von Mises stress at the slave, Tresca's and Orowan's the flow stress
!> there where it hardens, EXPONENTIAL DECAY the speed of slip. They are put in place between
!> iterations and stay in a line search: tangents do not know them, and the
!> residual that Newton ends with is that of the stress and the speed which it ends with.
module lopin_lagged_friction
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_friction, only : reads_mises, reads_speed, reads_yield
   use lopin_nodal_mises, only : nodal_mises, nodal_flow_stress
   use lopin_slip_increment, only : speed_of
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: reads_lagged, start_lagged, renew_lagged, share_of_new, may_relax

   !> Residuals that fall by less beside the best before them: what is read runs in a cycle.
   real(wp), parameter :: falls = 0.5_wp
   !> Residuals below which that is looked at.
   real(wp), parameter :: near = 0.05_wp
   !> Such residuals after which half, and after which a quarter of what is new is read; and after
   !> which less would do no better.
   integer, parameter :: half_after = 2, quarter_after = 15, most_stalls = 30

contains

   !> Some law in force reads what the last iteration gave.
   pure logical function reads_lagged(scene)
      type(scene_type), intent(in) :: scene
      reads_lagged = .false.
      if (.not. allocated(scene%newton%contact%friction)) return
      reads_lagged = any(reads_mises(scene%newton%contact%friction)) &
         & .or. any(reads_speed(scene%newton%contact%friction)) &
         & .or. (scene%newton%flows .and. any(reads_yield(scene%newton%contact%friction)))
   end function reads_lagged

   !> From what is accepted: an increment tried again has the same bits.
   subroutine start_lagged(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      associate (contact => scene%newton%contact)
         contact%speed = scene%accepted%contact%speed
         if (any(reads_mises(contact%friction))) call put_mises(scene, model, &
            & scene%accepted%motion%u)
      end associate
      call put_yields(scene, model, scene%accepted%motion%u)
   end subroutine start_lagged

   !> From the trial state, or a share of the way there.
   subroutine renew_lagged(scene, model, share)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: share            !! of what is new, 0..1 [-]
      real(wp), dimension(scene%newton%contact%n) :: speed, mises, yield
      integer :: i

      associate (contact => scene%newton%contact)
         speed = contact%speed(:contact%n)
         mises = contact%mises(:contact%n)
         yield = contact%yield(:contact%n)
         if (any(reads_speed(contact%friction))) contact%speed = &
            & [(speed_of(contact, i), i=1, contact%n)]
         if (any(reads_mises(contact%friction))) call put_mises(scene, model, scene%trial%motion%u)
         call put_yields(scene, model, scene%trial%motion%u)
         if (.not. share < 1.0_wp) return
         contact%speed(:contact%n) = speed + share*(contact%speed(:contact%n) - speed)
         contact%mises(:contact%n) = mises + share*(contact%mises(:contact%n) - mises)
         contact%yield(:contact%n) = yield + share*(contact%yield(:contact%n) - yield)
      end associate
   end subroutine renew_lagged

   !> How much of what is new to read: all of it while that contracts. What is read and what it
   !> makes of the state may chase each other in a cycle; the mean of both then ends it.
   pure real(wp) function share_of_new(residual) result(share)
      real(wp), intent(in) :: residual(:)      !! of all looks so far [-]

      share = 1.0_wp
      if (.not. is_near(residual)) return
      if (stalls(residual) >= half_after) share = 0.5_wp
      if (stalls(residual) >= quarter_after) share = 0.25_wp
   end function share_of_new

   !> Reading less of what is new may still end the iteration.
   pure logical function may_relax(residual)
      real(wp), intent(in) :: residual(:)      !! of all looks so far [-]
      may_relax = is_near(residual)
      if (may_relax) may_relax = stalls(residual) < most_stalls
   end function may_relax

   !> Close to an answer; further out it is not what is read that Newton chases.
   pure logical function is_near(residual)
      real(wp), intent(in) :: residual(:)
      is_near = size(residual) > 1
      if (is_near) is_near = minval(residual(2:)) < near
   end function is_near

   !> Looks whose residual has not fallen.
   pure integer function stalls(residual)
      real(wp), intent(in) :: residual(:)
      integer :: i

      stalls = 0
      do i = 4, size(residual)
         if (residual(i) > falls*minval(residual(2:i - 1))) stalls = stalls + 1
      end do
   end function stalls

   !> The stress of these displacements at the slave points.
   subroutine put_mises(scene, model, displacement)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: displacement(:)  !! (ndof) [length]
      real(wp) :: u(3, model%mesh%nnode), mises(model%mesh%nnode)

      u = at_nodes(scene%dofs, displacement, model%mesh%nnode, model%mesh%ndim)
      call nodal_mises(scene%solids, model%mesh, u, scene%newton%past, mises)
      associate (contact => scene%newton%contact)
         contact%mises = mises(contact%node(:contact%n))
      end associate
   end subroutine put_mises

   !> The flow stress that the solids have with these displacements; where nothing flows, that of
   !> the deck stays. At rest a viscous solid has none: friction never takes less than a trace of
   !> it.
   subroutine put_yields(scene, model, displacement)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: displacement(:)  !! (ndof) [length]
      real(wp), parameter :: trace = 1.0e-6_wp
      real(wp) :: yield(model%mesh%nnode)
      integer :: i

      if (.not. scene%newton%flows) return
      if (.not. any(reads_yield(scene%newton%contact%friction))) return
      call nodal_flow_stress(scene%solids, model%mesh, displacement, scene%newton%past, &
         & scene%trial%solids, yield)
      if (.not. maxval(yield) > 0.0_wp) return
      associate (contact => scene%newton%contact)
         do i = 1, contact%n
            associate (own => yield(contact%node(i)))
               if (own > 0.0_wp) contact%yield(i) = max(own, trace*maxval(yield))
            end associate
         end do
      end associate
   end subroutine put_yields

   pure function at_nodes(dofs, displacement, nnode, ndim) result(u)
      type(dofs_type), intent(in) :: dofs
      real(wp), intent(in) :: displacement(:)
      integer, intent(in) :: nnode, ndim
      real(wp) :: u(3, nnode)
      integer :: node, k

      u = 0.0_wp
      do node = 1, nnode
         do k = 1, ndim
            if (dofs%id(k, node) > 0) u(k, node) = displacement(dofs%id(k, node))
         end do
      end do
   end function at_nodes
end module lopin_lagged_friction
