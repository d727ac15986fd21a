!> The stress-free state of a solid: reference temperatures and initial stresses.
!>
!> Both are an elastic strain beside that of the deformation. Its change of volume is added to ln J
!> in the memory of each point, its deviator is a plastic metric of the start.
module lopin_stress_free_state
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_quadrature, only : calculix_order
   use lopin_element_type, only : element_formulation
   use lopin_log_strain, only : log_frame_type, new_log_frame, first_axis, second_axis, &
      & exp_minus_one
   use lopin_solids, only : solids_type, group_type
   use lopin_flow_curve, only : flow_at, flow_stress
   use lopin_model, only : initial_stress_type
   use lopin_state, only : solids_state_type
   use lopin_material_memory, only : offset_at, put_metric, put_map, temperature_at, &
      & strain_at, stress_at
   implicit none
   private
   public :: heat_points, stress_points, temper_points, set_elastic

contains

   !> Change the temperatures of the nodes by `rise` since what the memory holds: the offset of
   !> every point is its stress of the start, `pressed`, less three times the linear expansion.
   !>
   !> An element whose change of volume is a mean expands by a mean.
   subroutine heat_points(memory, solids, mesh, rise, pressed)
      type(solids_state_type), intent(inout) :: memory
      type(solids_type), intent(in) :: solids
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: rise(:)      !! (nnode) since the start [temperature]
      real(wp), intent(in) :: pressed(:)   !! (ncolumn) of stress_points [-]
      integer :: e, p, q

      do e = 1, mesh%nelement
         p = memory%first(e)
         q = memory%first(e + 1) - 1
         if (q < p) cycle
         associate (group => solids%group(solids%which(e)))
            memory%value(offset_at(group%element%nstress), p:q) = pressed(p:q) &
               & - 3.0_wp*group%expansion*at_points(group, rise(mesh%conn(:group%element%nnode, e)))
         end associate
      end do
   end subroutine heat_points

   !> Temperatures of the points whose flow stress looks at it; of those that have not flowed, the
   !> flow stress is that of the temperature.
   subroutine temper_points(memory, solids, mesh, temperature)
      type(solids_state_type), intent(inout) :: memory
      type(solids_type), intent(in) :: solids
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: temperature(:)   !! (nnode) [temperature]
      real(wp) :: stress, slope, rate_slope
      integer :: e, m, p, q, k

      do e = 1, mesh%nelement
         p = memory%first(e)
         q = memory%first(e + 1) - 1
         if (q < p) cycle
         associate (group => solids%group(solids%which(e)))
            if (.not. allocated(group%law%flow%temperature)) cycle
            m = group%element%nstress
            memory%value(temperature_at(m), p:q) = at_points(group, &
               & temperature(mesh%conn(:group%element%nnode, e)))
            do k = p, q
               if (memory%value(strain_at(m), k) > 0.0_wp) cycle
               call flow_stress(flow_at(group%law%flow, memory%value(temperature_at(m), k)), &
                  & 0.0_wp, 0.0_wp, stress, slope, rate_slope)
               memory%value(stress_at(m), k) = stress
               if (allocated(group%law%plastic)) memory%value(temperature_at(m) + 1, k) = stress
            end do
         end associate
      end do
   end subroutine temper_points

   pure function at_points(group, nodal) result(value)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: nodal(:)
      real(wp) :: value(group%element%ngauss)

      if (group%element%formulation /= element_formulation%bbar) then
         value = matmul(nodal, group%element%n)
      else
         value = sum(nodal)/size(nodal)
      end if
   end function at_points

   !> Write the deviator of a stress of the start into the memory of an element; its change of
   !> volume goes beside it. Not found: the element has no such point.
   subroutine stress_points(memory, solids, start, found)
      type(solids_state_type), intent(inout) :: memory
      type(solids_type), intent(in) :: solids
      type(initial_stress_type), intent(in) :: start
      logical, intent(out) :: found
      real(wp) :: strain(3, 3), pressure
      integer :: i, p, q, r

      p = memory%first(start%element)
      q = memory%first(start%element + 1) - 1
      found = .true.
      if (q < p) return
      associate (group => solids%group(solids%which(start%element)), stress => start%stress, &
         & volume => memory%pressed)
         if (start%point /= 0) then
            associate (order => calculix_order(group%element%xi))
               found = start%point > 0 .and. start%point <= size(order)
               if (.not. found) return
               p = p + order(start%point) - 1
               q = p
            end associate
         end if
         pressure = sum(stress(:3))/3.0_wp
         volume(p:q) = pressure/group%law%bulk
         do r = 1, 6
            strain(first_axis(r), second_axis(r)) = stress(r)/(2.0_wp*group%law%shear)
            strain(second_axis(r), first_axis(r)) = strain(first_axis(r), second_axis(r))
         end do
         do i = 1, 3
            strain(i, i) = strain(i, i) - pressure/(2.0_wp*group%law%shear)
         end do
         do r = p, q
            call set_elastic(memory%value(:, r), group, strain, memory%finite_strain)
         end do
      end associate
   end subroutine stress_points

   !> The plastic metric of a point whose elastic part is that of a strain without change of volume.
   pure subroutine set_elastic(column, group, strain, finite_strain)
      real(wp), intent(inout) :: column(:)      !! of the memory
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: strain(3, 3)      !! elastic, logarithmic [-]
      logical, intent(in) :: finite_strain
      type(log_frame_type) :: frame
      real(wp) :: metric(3, 3), part(3)
      integer :: i, j

      if (.not. finite_strain) then
         call put_metric(column, group%element%nstress, 2.0_wp*strain)
         return
      end if
      ! exp(2 strain) - 1 in the axes of the strain, whose own frame has ln(1 + strain)/2.
      call new_log_frame(frame, strain)
      part = exp_minus_one(2.0_wp*exp_minus_one(2.0_wp*frame%e))
      if (allocated(group%law%plastic)) part = part/(1.0_wp + sqrt(1.0_wp + part))
      do j = 1, 3
         do i = 1, 3
            metric(i, j) = sum(part*frame%axis(i, :)*frame%axis(j, :))
         end do
      end do
      if (allocated(group%law%plastic)) then
         call put_map(column, group%element%nstress, metric)
      else
         call put_metric(column, group%element%nstress, metric)
      end if
   end subroutine set_elastic
end module lopin_stress_free_state
