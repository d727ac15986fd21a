!> Bounds of friction that follow the stress of the solids on the nonlinear path, exactly.
!>
!> Cristescu's law reads the von Mises stress at the slave, Tresca's and Orowan's the flow stress
!> there where it hardens. Every look at a trial state reads its own stress, and the tangent knows
!> how the bound of a sliding point moves with the places around: each such point adds a product of
!> two vectors to it. Newton keeps its order; read of the iteration before, a bound that grows with
!> the shear which it allows would converge by a factor an iteration, or run in a cycle.
module lopin_followed_stress
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_friction, only : reads_mises, reads_yield, bound_slopes
   use lopin_solid_configuration, only : configuration_type
   use lopin_slip_increment, only : condition_at
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_local_matrix, only : local_matrix_type
   use lopin_surface_stress, only : new_surface_stress, find_stress
   use lopin_surface_slopes, only : slopes_type, find_slopes
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: choose_followers, follow_stress, follow_slopes

   !> Flow stresses below this share of the largest are none: a viscous solid at rest has none.
   real(wp), parameter :: trace = 1.0e-6_wp

contains

   !> Which pairs follow; of the present step.
   subroutine choose_followers(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: i

      associate (contact => scene%newton%contact)
         if (.not. allocated(contact%friction)) return
         contact%follows = reads_mises(contact%friction) .or. scene%newton%flows &
            & .and. reads_yield(contact%friction)
         if (.not. any(contact%follows)) return
         call new_surface_stress(scene%newton%surface, scene%solids, model%mesh, &
            & pack(contact%node(:contact%n), [(contact%follows(contact%pair(i)), &
            & i=1, contact%n)]), scene%newton%flows, any(reads_mises(contact%friction)))
      end associate
   end subroutine choose_followers

   !> What the laws read at the trial. Where nothing flows, the yield stress of the deck stays.
   subroutine follow_stress(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), allocatable :: mises(:), flow(:)
      integer :: i

      associate (contact => scene%newton%contact, surface => scene%newton%surface)
         if (.not. any(contact%follows)) return
         allocate (mises(size(surface%node)), flow(size(surface%node)))
         call find_stress(surface, scene%solids, model%mesh, scene%trial%motion%u, &
            & scene%newton%past, mises, flow)
         do i = 1, contact%n
            if (.not. contact%follows(contact%pair(i))) cycle
            associate (place => surface%place(contact%node(i)))
               contact%mises(i) = mises(place)
               if (flow(place) > 0.0_wp) contact%yield(i) = max(flow(place), trace*maxval(flow))
            end associate
         end do
      end associate
   end subroutine follow_stress

   !> Slopes of the bounds of points that slide, in their local matrices.
   subroutine follow_slopes(scene, model)
      type(scene_type), intent(inout), target :: scene
      type(model_type), intent(in), target :: model
      type(slopes_type), allocatable :: slopes(:)
      real(wp) :: by_stress(2, scene%newton%contact%nlocal)
      logical :: wanted(model%mesh%nnode)
      integer :: i

      associate (contact => scene%newton%contact, surface => scene%newton%surface)
         if (.not. any(contact%follows)) return
         wanted = .false.
         do i = 1, contact%nlocal
            associate (l => contact%local(i))
               call slopes_of_bound(contact, l, by_stress(:, i))
               if (allocated(l%by_bound)) wanted(contact%node(l%point)) = .true.
            end associate
         end do
         if (.not. any(wanted)) return
         call find_slopes(surface, configuration_type(scene%solids, model%mesh, &
            & scene%trial%motion%u, scene%newton%past), scene%trial%motion%u, &
            & wanted(surface%node), [any(by_stress(2, :) > 0.0_wp), any(by_stress(1, :) &
            & > 0.0_wp)], slopes)
         do i = 1, contact%nlocal
            associate (l => contact%local(i))
               if (.not. allocated(l%by_bound)) cycle
               associate (s => slopes(surface%place(contact%node(l%point))))
                  l%read_dof = s%dof(:s%n)
                  l%read_slope = by_stress(1, i)*s%flow(:s%n) + by_stress(2, i)*s%mises(:s%n)
               end associate
            end associate
         end do
      end associate
   end subroutine follow_slopes

   !> Of the logarithm of the bound of a point by flow stress and von Mises stress; a bound that
   !> nothing hangs on, or that follows neither, is forgotten.
   pure subroutine slopes_of_bound(contact, local, by_stress)
      type(nonlinear_contact_type), intent(in) :: contact
      type(local_matrix_type), intent(inout) :: local
      real(wp), intent(out) :: by_stress(2)    !! [1/stress]
      real(wp) :: radius

      by_stress = 0.0_wp
      if (.not. allocated(local%by_bound)) return
      call bound_slopes(contact%friction(contact%pair(local%point)), &
         & contact%pressure(local%point), condition_at(contact, local%point), radius, &
         & by_stress(1), by_stress(2))
      if (any(by_stress > 0.0_wp) .and. any(abs(local%by_bound) > 0.0_wp)) then
         by_stress = by_stress/radius
      else
         deallocate (local%by_bound)
      end if
   end subroutine slopes_of_bound
end module lopin_followed_stress
